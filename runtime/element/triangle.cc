#include "runtime/element/triangle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace palpate::triangle {
namespace {

// Square of the smallest sine between two edges that still makes a triangle.
constexpr Real kFlatSquared = rounding(1e-18, 1e-12);

}  // namespace

Vector3 area_coordinates(const Matrix3& corner_m, const Vector3& p_m) noexcept {
  const Vector3 e1 = corner_m.col(1) - corner_m.col(0);
  const Vector3 e2 = corner_m.col(2) - corner_m.col(0);
  const Vector3 r = p_m - corner_m.col(0);
  const Vector3 n = e1.cross(e2);
  const Real nn = n.squaredNorm();
  if (flat(e1, e2)) {
    return {1.0, 0.0, 0.0};
  }
  const Real w1 = r.cross(e2).dot(n) / nn;
  const Real w2 = e1.cross(r).dot(n) / nn;
  return {1.0 - w1 - w2, w1, w2};
}

Vector3 nearest_inside(const Matrix3& corner_m, const Vector3& area) noexcept {
  if (area.minCoeff() >= 0.0) {
    return area;
  }
  const Vector3 p = corner_m * area;
  Vector3 nearest(1.0, 0.0, 0.0);
  Real nearest_squared = std::numeric_limits<Real>::infinity();
  for (int j = 0; j < 3; ++j) {
    const int k = (j + 1) % 3;
    const Vector3 edge = corner_m.col(k) - corner_m.col(j);
    const Real length2 = edge.squaredNorm();
    const Real along = (p - corner_m.col(j)).dot(edge);
    const Real t = length2 > 0.0 ? std::clamp(along / length2, 0.0, 1.0) : 0.0;
    const Real squared = (corner_m.col(j) + t * edge - p).squaredNorm();
    if (squared < nearest_squared) {
      nearest_squared = squared;
      nearest.setZero();
      nearest(j) = 1.0 - t;
      nearest(k) = t;
    }
  }
  return nearest;
}

bool flat(const Vector3& edge1_m, const Vector3& edge2_m) noexcept {
  return !(edge1_m.cross(edge2_m).squaredNorm() >
           kFlatSquared * edge1_m.squaredNorm() * edge2_m.squaredNorm());
}

}  // namespace palpate::triangle
