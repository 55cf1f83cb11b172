#include "precompute/surface/winding_number.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "formats/base/reproducible.h"

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
    // Solid angle (van Oosterom, Strackee 1983): tan(angle / 2) = a . (b x c) over
    // |a||b||c| + (a . b)|c| + (b . c)|a| + (c . a)|b|.
    angle +=
        2.0 * reproducible::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc +
                                                         b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4.0 * std::numbers::pi);
}

namespace {

// Van der Corput's sequence.
double radical_inverse(int base, int i) {
  double value = 0.0;
  double digit = 1.0 / base;
  for (; i > 0; i /= base, digit /= base) {
    value += digit * (i % base);
  }
  return value;
}

}  // namespace

double share_outside(const SurfaceMesh& mesh, const SurfaceMesh& of) {
  constexpr int kWanted = 200;
  constexpr int kTried = 100 * kWanted;
  constexpr int kFewest = 10;
  const Eigen::AlignedBox3d box = bounding_box(mesh);
  const auto is_inside = [](const SurfaceMesh& surface, const Eigen::Vector3d& p) {
    return std::abs(winding_number(surface, p)) >= 0.5;
  };
  int inside = 0;
  int lost = 0;
  for (int i = 1; i <= kTried && inside < kWanted; ++i) {
    // Halton's points in the box, until enough lie in the mesh.
    const Eigen::Vector3d unit(radical_inverse(2, i), radical_inverse(3, i),
                               radical_inverse(5, i));
    const Eigen::Vector3d p = box.min() + unit.cwiseProduct(box.sizes());
    if (is_inside(mesh, p)) {
      ++inside;
      lost += is_inside(of, p) ? 0 : 1;
    }
  }
  return inside < kFewest ? 1.0 : static_cast<double>(lost) / inside;
}

}  // namespace palpate
