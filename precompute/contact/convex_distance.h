// Geometry of a convex triangle mesh: nearest points, and the shadow of its lower end.
#pragma once

#include <array>
#include <limits>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

using TriangleCorners = std::array<Eigen::Vector3d, 3>;

[[nodiscard]] TriangleCorners corners_of(const SurfaceMesh& mesh,
                                         Eigen::Index triangle);

/// The point of a set of triangles nearest to another, and on what it lies.
struct NearestPoint {
  double distance_m = std::numeric_limits<double>::infinity();
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
  int corners = 0;  ///< that span it: 1 a corner, 2 an edge, 3 the inside
  Eigen::Vector3d edge = Eigen::Vector3d::Zero();  ///< [m] along the edge, if on one
  Eigen::Vector3d face_normal = Eigen::Vector3d::Zero();  ///< [-] unit, of the triangle
};

/// Replaces `nearest` by the triangle's nearest point if that is nearer (Ericson 2005,
/// section 5.1.5).
void take_nearer(NearestPoint& nearest, const Eigen::Vector3d& p_m,
                 const TriangleCorners& corner);

/// Area [m^2] of the shadow along z of the part of a convex mesh that lies at most
/// depth_m above its lowest point.
[[nodiscard]] double shadow_area_m2(const SurfaceMesh& mesh, double depth_m);

}  // namespace palpate
