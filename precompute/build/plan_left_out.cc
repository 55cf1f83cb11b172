#include "precompute/build/plan_left_out.h"

#include <cmath>

#include <fmt/format.h>

namespace palpate {

std::vector<std::string> left_out_of(const Scene& scene, const PressStrategy& strategy,
                                     const PlanReport& report) {
  std::vector<std::string> left_out;
  const auto say = [&](bool is_so, std::string line) {
    if (is_so) {
      left_out.push_back(std::move(line));
    }
  };
  say(report.held > 0, fmt::format("{} nodes: a support holds them", report.held));
  say(report.outside_reach > 0,
      fmt::format("{} nodes: outside reach.box_m", report.outside_reach));
  say(true, fmt::format("depths past {:.4g} mm: reach.depth_max_m",
                        1e3 * scene.reach.depth_max_m));
  say(std::isfinite(scene.reach.force_max_n),
      fmt::format("forces past {:.4g} N: reach.force_max_n", scene.reach.force_max_n));
  say(!strategy.nonlinear,
      fmt::format("nonlinear solutions: {}", scene.accuracy.method == "linear"
                                                 ? "accuracy.method is linear"
                                                 : "every material is linear"));
  say(strategy.nonlinear && report.nonlinear_depths < report.depths,
      fmt::format("nonlinear solutions at {} of {} depths: their ratio to the linear "
                  "force is interpolated where that suffices",
                  report.depths - report.nonlinear_depths, report.depths));
  say(report.interpolated_expected > 0,
      fmt::format(
          "full presses of about {} of {} nodes: interpolated within the budget "
          "of {:.3g} %",
          report.interpolated_expected, report.reachable * report.tools,
          100 * scene.force_relative));
  say(strategy.shared_mesh && report.columns > 0,
      "fine elements away from the surface: tets grow inwards");
  say(strategy.cut_out, cut_out_text(scene));
  say(!strategy.shared_mesh && !strategy.cut_out,
      "fine elements away from the contact: every group of "
      "nodes has a mesh graded to it");
  say(!scene.drawing.displacement,
      "displacement fields: drawing.displacement is not set");
  return left_out;
}

std::vector<std::string> support_notes(const Scene& scene, const SurfaceMesh& surface) {
  std::vector<std::string> notes;
  for (const double area_m2 : supported_areas_m2(scene, surface)) {
    const bool fixed = scene.support[notes.size()].is_fixed();
    notes.push_back(fmt::format("support {} {} {:.4g} cm^2 of the surface",
                                notes.size() + 1, fixed ? "holds" : "has springs under",
                                1e4 * area_m2));
  }
  return notes;
}

}  // namespace palpate
