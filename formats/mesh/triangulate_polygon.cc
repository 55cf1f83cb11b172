#include "formats/mesh/triangulate_polygon.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

namespace palpate {
namespace {

using Corners = std::span<const Eigen::Vector3d>;
using Triple = std::array<std::size_t, 3>;

// Twice the polygon's vector area (Newell).
Eigen::Vector3d area_normal(Corners p) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < p.size(); ++i) {
    normal += (p[i] - p[0]).cross(p[(i + 1) % p.size()] - p[0]);
  }
  return normal;
}

// Twice the area of a triangle in the plane across `normal`; negative if clockwise.
double turn(Corners p, const Triple& t, const Eigen::Vector3d& normal) {
  return (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).dot(normal);
}

bool inside(Corners p, const Triple& t, std::size_t point,
            const Eigen::Vector3d& normal) {
  return turn(p, {t[0], t[1], point}, normal) >= 0.0 &&
         turn(p, {t[1], t[2], point}, normal) >= 0.0 &&
         turn(p, {t[2], t[0], point}, normal) >= 0.0;
}

double smallest_angle(Corners p, const Triple& t) {
  double smallest = 4.0;
  for (std::size_t j = 0; j < 3; ++j) {
    const Eigen::Vector3d a = p[t[(j + 1) % 3]] - p[t[j]];
    const Eigen::Vector3d b = p[t[(j + 2) % 3]] - p[t[j]];
    smallest = std::min(smallest, std::atan2(a.cross(b).norm(), a.dot(b)));
  }
  return smallest;
}

// Which corner of the remaining polygon to cut off; the second one if none is an ear.
std::size_t best_ear(Corners p, const std::vector<std::size_t>& left,
                     const Eigen::Vector3d& normal) {
  const std::size_t n = left.size();
  std::size_t best = 1;
  double best_angle = -1.0;
  for (std::size_t i = 0; i < n; ++i) {
    const Triple ear{left[(i + n - 1) % n], left[i], left[(i + 1) % n]};
    const bool clear =
        turn(p, ear, normal) > 0.0 &&
        std::none_of(left.begin(), left.end(), [&](auto q) {
          return q != ear[0] && q != ear[1] && q != ear[2] && inside(p, ear, q, normal);
        });
    if (!clear) {
      continue;
    }
    // What is left of a quadrangle is a triangle too: judge both.
    double angle = smallest_angle(p, ear);
    if (n == 4) {
      const Triple rest{ear[2], left[(i + 2) % n], ear[0]};
      angle =
          turn(p, rest, normal) > 0.0 ? std::min(angle, smallest_angle(p, rest)) : 0.0;
    }
    if (angle > best_angle) {
      best = i;
      best_angle = angle;
    }
  }
  return best;
}

}  // namespace

std::vector<Triple> triangulate_polygon(Corners corner_m) {
  const Eigen::Vector3d normal = area_normal(corner_m);
  std::vector<std::size_t> left(corner_m.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  std::vector<Triple> triangles;
  while (left.size() > 3) {
    const std::size_t n = left.size();
    const std::size_t i = best_ear(corner_m, left, normal);
    triangles.push_back({left[(i + n - 1) % n], left[i], left[(i + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

}  // namespace palpate
