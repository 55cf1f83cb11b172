#include "runtime/fast/triangle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace palpate::triangle {
namespace {

// Square of the smallest sine between two edges that still makes a triangle.
constexpr double kFlatSquared = 1e-18;

}  // namespace

Eigen::Vector3d area_coordinates(const Eigen::Matrix3d& corner_m,
                                 const Eigen::Vector3d& p_m) noexcept {
  const Eigen::Vector3d e1 = corner_m.col(1) - corner_m.col(0);
  const Eigen::Vector3d e2 = corner_m.col(2) - corner_m.col(0);
  const Eigen::Vector3d r = p_m - corner_m.col(0);
  const Eigen::Vector3d n = e1.cross(e2);
  const double nn = n.squaredNorm();
  if (flat(e1, e2)) {
    return {1.0, 0.0, 0.0};
  }
  const double w1 = r.cross(e2).dot(n) / nn;
  const double w2 = e1.cross(r).dot(n) / nn;
  return {1.0 - w1 - w2, w1, w2};
}

Eigen::Vector3d nearest_inside(const Eigen::Matrix3d& corner_m,
                               const Eigen::Vector3d& area) noexcept {
  if (area.minCoeff() >= 0.0) {
    return area;
  }
  const Eigen::Vector3d p = corner_m * area;
  Eigen::Vector3d nearest(1.0, 0.0, 0.0);
  double nearest_squared = std::numeric_limits<double>::infinity();
  for (int j = 0; j < 3; ++j) {
    const int k = (j + 1) % 3;
    const Eigen::Vector3d edge = corner_m.col(k) - corner_m.col(j);
    const double length2 = edge.squaredNorm();
    const double along = (p - corner_m.col(j)).dot(edge);
    const double t = length2 > 0.0 ? std::clamp(along / length2, 0.0, 1.0) : 0.0;
    const double squared = (corner_m.col(j) + t * edge - p).squaredNorm();
    if (squared < nearest_squared) {
      nearest_squared = squared;
      nearest.setZero();
      nearest(j) = 1.0 - t;
      nearest(k) = t;
    }
  }
  return nearest;
}

bool flat(const Eigen::Vector3d& edge1_m, const Eigen::Vector3d& edge2_m) noexcept {
  return !(edge1_m.cross(edge2_m).squaredNorm() >
           kFlatSquared * edge1_m.squaredNorm() * edge2_m.squaredNorm());
}

}  // namespace palpate::triangle
