// Fields of log force over a body as the responses of a database.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "fitting/surface/attached_point.h"
#include "formats/database/response_database.h"

namespace palpate {

struct SurfaceFields {
  Eigen::VectorXd depth_m;     ///< (k) [m] > 0, increasing
  Eigen::MatrixXd log_force;   ///< (n x k) [-] log of force over 1 N
  Eigen::MatrixXd sd;          ///< (n x k) [-] its standard deviation
  std::vector<char> measured;  ///< (n) 1 at nodes that have a probe
  std::vector<char> far;       ///< (n) 1 at nodes too far from every probe
};

/// A direction that was measured at a point of the surface.
struct ProbeDirection {
  AttachedPoint at;
  Eigen::Vector3d direction;  ///< [-] unit, outward
};

/// Unit directions at the nodes (n x 3): the normals, turned by the mean deviation of
/// the directions measured nearby. The mean has Gaussian weights of the width given [m]
/// and a twentieth of one direction's weight for the bare normal.
[[nodiscard]] Points node_directions(const SurfaceMesh& body,
                                     std::span<const ProbeDirection> probes,
                                     double width_m);

/// One tool, curves through (0, 0) and exp(log force), held where they would fall; the
/// standard deviations as errors. Without measurement and provenance.
/// @throws InputError for a tool or a field out of range.
[[nodiscard]] ResponseDatabase surface_database(const SurfaceMesh& body,
                                                const ToolShape& tool,
                                                const Points& direction,
                                                const SurfaceFields& fields);

/// Nodes whose log force falls with depth somewhere.
[[nodiscard]] std::size_t straightened(const SurfaceFields& fields);

}  // namespace palpate
