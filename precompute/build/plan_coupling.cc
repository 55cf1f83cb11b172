#include "precompute/build/plan_coupling.h"

#include <algorithm>

#include "formats/base/stopwatch.h"
#include "precompute/press/contact_coupling.h"
#include "precompute/press/joint_presses.h"
#include "precompute/press/press_cost.h"
#include "precompute/process/machine_memory.h"
#include "precompute/process/peak_memory.h"

namespace palpate {
namespace {

// Its factor is one thread's work, its columns all threads'.
double table_seconds(const Scene& scene, const BodySource& body,
                     std::span<const std::int32_t> reachable,
                     const UniformSurface& surface, std::size_t workers) {
  const double triangles = static_cast<double>(surface.surface.triangle.rows());
  const double columns = static_cast<double>(
      contact_nodes_near(surface.surface, body, reachable,
                         touched_radius_m(scene, body, surface.node_spacing_m)));
  return expected_cpu_s({triangles, 0.0}) +
         columns * expected_column_cpu_s(triangles) / static_cast<double>(workers);
}

// Of its factor, and of what modes are found of: compliances of all pairs, and what the
// table leaves of them.
double table_bytes(std::span<const std::int32_t> reachable,
                   const UniformSurface& surface) {
  const auto pairs =
      static_cast<double>(reachable.size()) * static_cast<double>(reachable.size());
  return expected_memory_bytes(surface.surface.triangle.rows()) +
         2.0 * sizeof(double) * pairs;
}

}  // namespace

void plan_coupling(const Scene& scene, const BodySource& body,
                   std::span<const std::int32_t> reachable, std::size_t workers,
                   Progress& progress, PlanReport& report) {
  if (!couples(scene)) {
    return;
  }
  const std::vector<double> distance_m = coupling_distances(scene, body, reachable);
  const UniformSurface surface = coupling_surface(body, distance_m.front());
  report.cost.push_back(
      cost_once("table of compliance, counted",
                table_seconds(scene, body, reachable, surface, workers)));
  report.peak_memory_bytes = std::max(
      report.peak_memory_bytes,
      peak_memory_bytes() + static_cast<std::int64_t>(table_bytes(reachable, surface)));
  const std::size_t sets = sets_of_build(scene);
  if (sets == 0) {
    return;
  }
  progress.stage("some of: joint presses");
  // What the table says does not matter here.
  ComplianceTable flat{.distance_m = distance_m};
  flat.value.setZero(body.surface.position_m.rows(), std::ssize(distance_m));
  const auto couples =
      std::find(scene.tool_couples.begin(), scene.tool_couples.end(), true);
  const double seconds = seconds_of([&] {
    (void)coupling_errors(
        scene, body,
        body.tool[static_cast<std::size_t>(couples - scene.tool_couples.begin())],
        reachable, flat, {.sets = workers}, progress);
  });
  const auto tools = static_cast<std::size_t>(
      std::count(scene.tool_couples.begin(), scene.tool_couples.end(), true));
  report.cost.push_back(
      cost_of_all("sets of joint presses", sets * tools, workers, seconds));
}

}  // namespace palpate
