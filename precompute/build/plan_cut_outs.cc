#include "precompute/build/plan_cut_outs.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "formats/base/stopwatch.h"
#include "precompute/press/cut_out_press.h"
#include "precompute/process/parallel.h"

namespace palpate {
namespace {

using Groups = std::vector<std::vector<std::int32_t>>;

// Presses some groups, evenly spread, at once.
PlanCost price(const CutOutSolver& solver, const BodySource& body,
               const std::string& work, const Groups& groups, std::size_t workers,
               double times_wider) {
  const std::size_t timed = std::min(workers, groups.size());
  const auto began = std::chrono::steady_clock::now();
  in_parallel(timed, [&](std::size_t i) {
    (void)solver.press(body.tool.front(),
                       groups[(2 * i + 1) * groups.size() / (2 * timed)], times_wider);
  });
  const double timed_s = seconds_since(began);
  return cost_of_all(work, groups.size() * body.tool.size(), timed, timed_s);
}

}  // namespace

void plan_cut_outs(const Scene& scene, const BodySource& body,
                   const PressStrategy& strategy,
                   std::span<const std::int32_t> vertices,
                   std::span<const WorkUnit> units, std::size_t workers,
                   Progress& progress, PlanReport& report) {
  const std::string once = "mesh to cut from, coarse body";
  progress.stage(once);
  const auto began = std::chrono::steady_clock::now();
  const CutOutSolver solver(scene, body, strategy.surface, strategy.spacing_m,
                            vertices);
  const double once_s = seconds_since(began);
  report.cost.push_back(cost_once(once, once_s));
  report.notes.push_back(solver.text());
  Groups groups;
  Groups checks;
  for (const WorkUnit& unit : units) {
    Groups of_unit = solver.groups(unit.vertex);
    std::move(of_unit.begin(), of_unit.end(),
              std::back_inserter(unit.is_check ? checks : groups));
  }
  progress.stage("a few parts");
  const ClampedPart part =
      solver.part(groups[groups.size() / 2], scene.cutout->radius_m);
  report.tets = part.model.mesh.tet.rows();
  report.unknowns = part.model.supports.free;
  report.cost.push_back(
      price(solver, body, "groups of presses on parts", groups, workers, 1.0));
  if (!checks.empty()) {
    report.cost.push_back(
        price(solver, body, "checks on wider parts", checks, workers, kCutStep));
  }
}

}  // namespace palpate
