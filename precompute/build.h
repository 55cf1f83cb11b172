// From a scene to its response database.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/response_database.h"
#include "formats/scene.h"
#include "precompute/body_model.h"
#include "precompute/indentation.h"
#include "precompute/progress.h"

namespace palpate {

struct BuildReport {
  std::int64_t nodes = 0;  ///< surface vertices of the body
  std::int64_t tets = 0;
  std::int64_t unknowns = 0;      ///< degrees of freedom solved for
  std::int64_t solved = 0;        ///< node responses, all tools
  std::int64_t interpolated = 0;  ///< none: every reachable node is solved
  std::int64_t failed = 0;
  std::int64_t untouched = 0;      ///< reachable, but the tool met nothing to press
  std::int64_t outside_reach = 0;  ///< held or outside the scene's reach
  std::int64_t over_budget = 0;    ///< error estimate above the scene's budget
  double error_median = 0.0;       ///< [-] of the estimates
  double error_p95 = 0.0;          ///< [-]
  double node_spacing_m = 0.0;     ///< [m] of the contact nodes, mean
  double min_dihedral_deg = 0.0;   ///< [deg] smallest angle between faces of a tet
  double seconds = 0.0;
  std::int64_t peak_memory_bytes = 0;
  std::vector<std::string> notes;
};

/// Presses every reachable vertex with every tool.
[[nodiscard]] ResponseDatabase build_database(const Scene& scene, Progress& progress,
                                              BuildReport& report);

struct IndentedVertex {
  IndentationPath path;
  Indentation indentation;
};

/// Presses one vertex with one tool.
/// @throws InputError if the vertex does not exist or is held.
[[nodiscard]] IndentedVertex indent_vertex(const Scene& scene, const BodyModel& body,
                                           const ToolShape& tool, std::int64_t vertex);

/// The vertex nearest to a point [m].
[[nodiscard]] std::int64_t nearest_vertex(const SurfaceMesh& surface,
                                          const Eigen::Vector3d& point_m);

}  // namespace palpate
