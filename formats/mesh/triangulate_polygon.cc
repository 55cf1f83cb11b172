#include "formats/mesh/triangulate_polygon.h"

#include <algorithm>
#include <numeric>

#include <Eigen/Geometry>

#include "formats/mesh/angle_between.h"

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
    smallest = std::min(smallest, angle_between(a, b));
  }
  return smallest;
}

// The corners that are left, each with what is known of the triangle that cutting it
// would take. A corner that lay outside of such a triangle stays outside: the search
// for one inside goes on where it stopped, so that all of it takes n^2 steps.
class Ears {
 public:
  explicit Ears(Corners p)
      : p_(p), normal_(area_normal(p)), left_(p.size()), ear_(p.size()) {
    std::iota(left_.begin(), left_.end(), std::size_t{0});
  }

  [[nodiscard]] std::size_t count() const { return left_.size(); }

  // Around place i of those that are left.
  [[nodiscard]] Triple around(std::size_t i) const {
    const std::size_t n = left_.size();
    return {left_[(i + n - 1) % n], left_[i], left_[(i + 1) % n]};
  }

  // The place to cut off: the best-shaped ear, the second place if there is none.
  [[nodiscard]] std::size_t best() {
    std::size_t best = 1;
    double best_angle = -1.0;
    for (std::size_t i = 0; i < left_.size(); ++i) {
      if (!is_clear(i)) {
        continue;
      }
      const double angle = angle_of(i);
      if (angle > best_angle) {
        best = i;
        best_angle = angle;
      }
    }
    return best;
  }

  void cut(std::size_t i) {
    const Triple triple = around(i);
    ear_[triple[0]] = {};
    ear_[triple[2]] = {};
    ear_[triple[1]].gone = true;
    left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(i));
  }

 private:
  struct Ear {
    bool gone = false;
    std::size_t tried = 0;  // corners below it are not inside
    double angle = -1.0;    // [rad] smallest; negative: not known yet
  };

  bool is_clear(std::size_t i) {
    const Triple ear = around(i);
    if (!(turn(p_, ear, normal_) > 0.0)) {
      return false;
    }
    std::size_t& q = ear_[ear[1]].tried;
    while (q < p_.size() && (ear_[q].gone || q == ear[0] || q == ear[1] ||
                             q == ear[2] || !inside(p_, ear, q, normal_))) {
      ++q;
    }
    return q == p_.size();
  }

  // What is left of a quadrangle is a triangle too: both are judged.
  double angle_of(std::size_t i) {
    const Triple ear = around(i);
    double& angle = ear_[ear[1]].angle;
    if (angle < 0.0) {
      angle = smallest_angle(p_, ear);
    }
    if (left_.size() != 4) {
      return angle;
    }
    const Triple rest{ear[2], left_[(i + 2) % 4], ear[0]};
    return turn(p_, rest, normal_) > 0.0 ? std::min(angle, smallest_angle(p_, rest))
                                         : 0.0;
  }

  Corners p_;
  Eigen::Vector3d normal_;
  std::vector<std::size_t> left_;
  std::vector<Ear> ear_;  // by corner
};

}  // namespace

std::vector<Triple> triangulate_polygon(Corners corner_m) {
  Ears ears(corner_m);
  std::vector<Triple> triangles;
  while (ears.count() > 3) {
    const std::size_t i = ears.best();
    triangles.push_back(ears.around(i));
    ears.cut(i);
  }
  triangles.push_back(ears.around(1));
  return triangles;
}

}  // namespace palpate
