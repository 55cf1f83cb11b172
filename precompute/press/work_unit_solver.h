// A scene cut into units of work, and the solution of each.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/database/work_unit.h"
#include "formats/scene/scene.h"
#include "precompute/body/scene_body.h"
#include "precompute/press/scene_solver.h"

namespace palpate {

/// Elements of checks beside those of a build. A linear check is a small part of a
/// build. Between vertices a nonlinear check has a mesh of its own that is as fine as a
/// build's. Such a check finds the field's error, not the mesh's. On meshes 1.5
/// times as fine checks of a gel take 3.7 times as long (MEASURED.md). At a vertex that
/// mesh may be the build's own.
inline constexpr double kLinearCheckTimesFiner = 2.0;
inline constexpr double kNonlinearCheckTimesFiner = 1.5;
[[nodiscard]] double check_times_finer(const PressStrategy& strategy,
                                       const SurfacePoint& place);

/// Full presses that an interpolation cluster of so many vertices will probably need at
/// a budget [-]. About a third of the vertices; all of a small cluster. Measured at a
/// budget of 5 % (MEASURED.md): a gel cylinder needs 0.40 of its vertices, an organ of
/// neo-Hookean material 0.32. Bodies whose forces change more from place to place need
/// more.
[[nodiscard]] std::size_t expected_samples(std::size_t vertices, double force_relative);

/// Either a cluster: neighbouring vertices that are answered together, some solved,
/// some interpolated from those. Or a check: one place of the surface, solved better.
struct WorkUnit {
  std::int64_t index = -1;
  bool is_check = false;
  std::vector<std::int32_t> vertex;  ///< ascending; of a check the nearest to its place
  SurfacePoint place = {};           ///< of a check; triangle -1: it is at its vertex
};

/// Interpolation clusters in the order of a space-filling curve, then checks. The same
/// for every shard and number of workers. Checks are drawn evenly over the area of
/// triangles whose vertices are all reachable. A check nearer to an edge than a tenth
/// of its triangle is put on the edge. Such a check stays a tenth of the edge from the
/// ends. So no sliver spoils the check's mesh. Where there is no such triangle, and
/// with [cutout], checks are at vertices.
/// @param vertices reachable ones, ascending.
[[nodiscard]] std::vector<WorkUnit> units_of(const Scene& scene, const BodySource& body,
                                             std::span<const std::int32_t> vertices);

/// Solves a unit for every tool. Nodes are solved fully until kriging of the ratio of
/// full and linear solutions is expected to keep the budget. It must keep the budget at
/// 95 % of all nodes (keeps_budget()); the rest is linear times ratio. A vertex whose
/// linear press is no valid predictor (is_predictor), or touches late (touches_late),
/// is solved.
///
/// Every node of the outcome keeps the rules of responses (broken_rule), or has failed
/// and says why. A failed node leaves the others as they are, but for those that would
/// have been interpolated from it.
/// @param solve_all no interpolation.
[[nodiscard]] WorkUnitOutcome solve_unit(const Scene& scene, const BodySource& body,
                                         const PressStrategy& strategy,
                                         const SceneSolver& solver,
                                         const WorkUnit& unit, bool solve_all);

/// The outcome of a unit of which nothing could be computed.
[[nodiscard]] WorkUnitOutcome failed_unit(const WorkUnit& unit, std::size_t tools,
                                          const std::string& reason);

}  // namespace palpate
