// Points given in space, attached to the surface that they were measured on.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

struct AttachedPoint {
  std::int32_t triangle = -1;
  Eigen::Vector3d weight = Eigen::Vector3d::Zero();  ///< [-] area coordinates, >= 0
  double distance_m = 0.0;  ///< [m] of the point in space from the surface
};

/// The closest point of the surface. On every triangle it is the projection onto the
/// triangle's plane where that lies inside, else the closest point of its edges. Ties
/// go to the first.
/// @throws InputError for a surface without triangles, or a point that is not finite.
[[nodiscard]] AttachedPoint closest_surface_point(const SurfaceMesh& mesh,
                                                  const Eigen::Vector3d& point_m);

/// Where it lies [m].
[[nodiscard]] Eigen::Vector3d position_m(const SurfaceMesh& mesh,
                                         const AttachedPoint& point);

/// The vertex with the largest weight.
[[nodiscard]] std::int32_t main_vertex(const SurfaceMesh& mesh,
                                       const AttachedPoint& point);

}  // namespace palpate
