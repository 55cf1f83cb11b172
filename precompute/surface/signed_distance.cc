#include "precompute/surface/signed_distance.h"

#include <limits>

#include <Eigen/Geometry>

namespace palpate {
namespace {

constexpr double kOnEdge = 1e-9;  // [-] of an area coordinate

}  // namespace

SignedDistance::SignedDistance(const SurfaceMesh& surface)
    : surface_(surface), search_(surface), normal_(vertex_normals(surface)) {}

Eigen::Vector3d SignedDistance::face_normal(Eigen::Index triangle) const {
  const auto corner = [&](int j) -> Eigen::Vector3d {
    return surface_.position_m.row(surface_.triangle(triangle, j)).transpose();
  };
  return (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
}

SignedDistance::Place SignedDistance::at_m(const Eigen::Vector3d& p_m) const {
  const SurfacePoint nearest = search_.nearest(p_m);
  if (nearest.triangle < 0) {
    return {std::numeric_limits<double>::infinity(), Eigen::Vector3d::UnitZ()};
  }
  Eigen::Vector3d between = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = face_normal(nearest.triangle);
  int zero = 0;
  int last_zero = 0;
  int last_one = 0;
  for (int j = 0; j < 3; ++j) {
    between += nearest.area_coordinate[j] *
               normal_.row(surface_.triangle(nearest.triangle, j)).transpose();
    const bool is_zero = nearest.area_coordinate[j] < kOnEdge;
    zero += is_zero ? 1 : 0;
    (is_zero ? last_zero : last_one) = j;
  }
  // The sign is that of the angle-weighted pseudonormal (Baerentzen, Aanaes 2005): of
  // the vertex, of both faces of an edge, or of the face.
  if (zero == 2) {
    normal = normal_.row(surface_.triangle(nearest.triangle, last_one)).transpose();
  } else if (zero == 1) {
    // Edge (j, j + 1) lies across from corner j + 2.
    const std::int32_t other =
        search_.neighbours()(nearest.triangle, (last_zero + 1) % 3);
    normal += other < 0 ? Eigen::Vector3d::Zero() : face_normal(other);
  }
  const double side = (p_m - nearest.position_m).dot(normal);
  return {side < 0.0 ? -nearest.distance_m : nearest.distance_m,
          between.norm() > 0.0 ? Eigen::Vector3d(between.normalized()) : normal};
}

}  // namespace palpate
