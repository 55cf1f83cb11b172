#include "precompute/build/build_coupling.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "formats/database/error_calibration.h"
#include "formats/response/memory_sites.h"
#include "precompute/press/contact_coupling.h"
#include "precompute/press/joint_presses.h"

namespace palpate {
namespace {

// Of sets of two to four contacts that are pressed jointly, the largest error of forces
// that follow from the table [-]; none where they are too few to tell.
std::vector<double> errors_of_sets(const Scene& scene, const BodySource& body,
                                   std::span<const std::int32_t> reachable,
                                   std::size_t tool, const ComplianceTable& coupling,
                                   Progress& progress) {
  const std::size_t sets = sets_of_build(scene);
  if (sets == 0) {
    return {};
  }
  progress.stage("joint presses");
  // Every tool has sets of its own, lest one odd draw speak for all.
  CouplingStudy study =
      coupling_errors(scene, body, body.tool[tool], reachable, coupling,
                      {.sets = sets, .seed = 1 + tool * sets}, progress);
  progress.finish();
  return study.worst_by_table.size() < kChecksToCalibrate
             ? std::vector<double>()
             : std::move(study.worst_by_table);
}

void state_coupling_errors(const std::vector<std::vector<double>>& by_tool,
                           ResponseDatabase& database) {
  std::vector<double> all;
  for (const auto& errors : by_tool) {
    all.insert(all.end(), errors.begin(), errors.end());
  }
  for (std::size_t t = 0; t < by_tool.size(); ++t) {
    if (!by_tool[t].empty()) {
      database.tools[t].compliance.error_relative =
          std::max(covering(by_tool[t]), covering(all));
    }
  }
}

}  // namespace

void add_coupling(const Scene& scene, const BodySource& body,
                  std::span<const std::int32_t> reachable, ResponseDatabase& database,
                  Progress& progress) {
  progress.stage("coupling of contacts");
  const ComplianceTable coupling =
      make_coupling_table(scene, body, reachable, progress);
  progress.finish();
  std::vector<std::vector<double>> errors(database.tools.size());
  for (std::size_t t = 0; t < database.tools.size(); ++t) {
    if (!scene.tool_couples[t]) {
      continue;
    }
    ResponseTable& table = database.tools[t];
    table.compliance = coupling;
    errors[t] = errors_of_sets(scene, body, reachable, t, coupling, progress);
    table.compliance.convex = one_equilibrium(
        coupling, table, body.surface.position_m,
        kClosestInRadii * contact_radius_m(table.tool, scene.reach.depth_max_m));
  }
  state_coupling_errors(errors, database);
}

}  // namespace palpate
