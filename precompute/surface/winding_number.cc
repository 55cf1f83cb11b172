#include "precompute/surface/winding_number.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace palpate {

double winding_number(const SurfaceMesh& mesh, const Eigen::Vector3d& point_m) {
  double angle = 0.0;
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    const auto from_point = [&](int j) -> Eigen::Vector3d {
      return mesh.position_m.row(mesh.triangle(t, j)).transpose() - point_m;
    };
    const Eigen::Vector3d a = from_point(0);
    const Eigen::Vector3d b = from_point(1);
    const Eigen::Vector3d c = from_point(2);
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    angle += 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc +
                                                     b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4.0 * std::numbers::pi);
}

}  // namespace palpate
