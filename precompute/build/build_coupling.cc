#include "precompute/build/build_coupling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "formats/database/error_calibration.h"
#include "formats/response/memory_sites.h"
#include "precompute/press/contact_coupling.h"
#include "precompute/press/joint_presses.h"

namespace palpate {
namespace {

// Of sets of two to four contacts that are pressed jointly, the largest error of forces
// that follow from the table [-], infinite where nobody knows; none where they are too
// few to tell.
std::vector<double> errors_of_sets(const Scene& scene, const BodySource& body,
                                   std::span<const std::int32_t> reachable,
                                   std::size_t tool, const ComplianceTable& coupling,
                                   std::vector<std::string>& notes,
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
  if (study.left_out > 0) {
    notes.push_back(fmt::format(
        "tool {}: {} of {} sets of contacts could not be pressed together: they count "
        "as misses of its table of compliance",
        body.tool[tool]->shape().name, study.left_out, sets));
  }
  std::vector<double> errors = std::move(study.worst_by_table);
  errors.insert(errors.end(), study.left_out, std::numeric_limits<double>::infinity());
  return errors.size() < kChecksToCalibrate ? std::vector<double>() : errors;
}

// No error is stated where more sets failed than may miss it.
void state_coupling_errors(const std::vector<std::vector<double>>& by_tool,
                           ResponseDatabase& database) {
  std::vector<double> all;
  for (const auto& errors : by_tool) {
    all.insert(all.end(), errors.begin(), errors.end());
  }
  for (std::size_t t = 0; t < by_tool.size(); ++t) {
    if (!by_tool[t].empty()) {
      const double error = std::max(covering(by_tool[t]), covering(all));
      database.tools[t].compliance.error_relative = std::isinf(error) ? 0.0 : error;
    }
  }
}

}  // namespace

std::vector<std::string> add_coupling(const Scene& scene, const BodySource& body,
                                      std::span<const std::int32_t> reachable,
                                      ResponseDatabase& database, Progress& progress) {
  std::vector<std::string> notes;
  if (is_nonlinear(scene, body)) {
    notes.emplace_back(
        "how contacts couple, and the error of that, is of the body at small strains");
  }
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
    errors[t] = errors_of_sets(scene, body, reachable, t, coupling, notes, progress);
    table.compliance.convex = one_equilibrium(
        coupling, table, body.surface.position_m,
        kClosestInRadii * contact_radius_m(table.tool, scene.reach.depth_max_m));
  }
  state_coupling_errors(errors, database);
  return notes;
}

}  // namespace palpate
