// What a build will compute, what it leaves out, and what that takes: said beforehand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/scene/scene.h"
#include "precompute/process/progress.h"
#include "precompute/surface/repair.h"

namespace palpate {

struct PlanOptions {
  bool solve_all = false;                ///< as BuildOptions
  int workers = 0;                       ///< as BuildOptions
  RepairMode repair = RepairMode::kOff;  ///< as BuildOptions
};

/// One kind of work: how often, and how long all of it takes. Work that is done once is
/// timed as it is. Other work is timed on a few vertices, by as many workers at once as
/// the build has, and multiplied.
struct PlanCost {
  std::string work;            ///< "columns of the surface compliance"
  std::int64_t count = 0;      ///< of all of it
  std::int64_t timed = 0;      ///< of those that were timed
  double timed_seconds = 0.0;  ///< wall time of these
  double seconds = 0.0;        ///< wall time of all
};

/// Work done once. @param times longer than what was timed in its place.
[[nodiscard]] inline PlanCost cost_once(const std::string& work, double timed_seconds,
                                        double times = 1.0) {
  return {work, 1, 1, timed_seconds, times * timed_seconds};
}

/// `timed` of `count` pieces of work. @param times longer than a timed one each takes.
[[nodiscard]] inline PlanCost cost_of_all(const std::string& work, std::size_t count,
                                          std::size_t timed, double timed_seconds,
                                          double times = 1.0) {
  const double share = static_cast<double>(count) / static_cast<double>(timed);
  return {work, static_cast<std::int64_t>(count), static_cast<std::int64_t>(timed),
          timed_seconds, times * share * timed_seconds};
}

struct PlanReport {
  std::int64_t nodes = 0;  ///< surface vertices of the body
  std::int64_t reachable = 0;
  std::int64_t held = 0;
  std::int64_t outside_reach = 0;  ///< neither reachable nor held
  std::int64_t tools = 0;
  std::int64_t units = 0;  ///< clusters and checks
  std::int64_t checks = 0;
  bool nonlinear = false;
  bool shared_mesh = false;
  bool cut_out = false;    ///< parts of one mesh, without a factor of the whole
  bool graded = false;     ///< full presses have meshes of their own
  int subdivisions = 0;    ///< of the shared mesh's surface
  double spacing_m = 0.0;  ///< [m] contact nodes: shared mesh, else under the contact
  std::int64_t tets = 0;   ///< shared mesh, else the first own mesh or part
  std::int64_t unknowns = 0;  ///< of the same
  std::int64_t columns = 0;   ///< solves for the surface compliance of the shared mesh
  int depths = 0;             ///< samples of a curve
  int nonlinear_depths = 0;   ///< of these, solved nonlinear
  std::int64_t solved_at_least = 0;        ///< responses
  std::int64_t solved_expected = 0;        ///< responses, and ...
  std::int64_t interpolated_expected = 0;  ///< ... the others
  std::vector<PlanCost> cost;
  double seconds = 0.0;  ///< wall time of the build
  std::int64_t peak_memory_bytes = 0;
  double plan_seconds = 0.0;          ///< what planning took
  std::vector<std::string> left_out;  ///< and why, one line each
  std::vector<std::string> notes;
};

/// Meshes, factorises and presses a few vertices as build() would, then counts. A press
/// that fails is not repeated, as build() does: bodies with many of these take longer
/// than is said.
/// @throws as build().
[[nodiscard]] PlanReport plan(const Scene& scene, const PlanOptions& options,
                              Progress& progress);

}  // namespace palpate
