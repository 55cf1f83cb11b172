#include "runtime/fast/friction_spring.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/LU>

#include "formats/response/tangent_frame.h"

namespace palpate {
namespace {

using Matrix2 = Eigen::Matrix<Real, 2, 2>;
using Frame = Eigen::Matrix<Real, 3, 2>;

// A closest point projection takes so many steps of Newton's method at most.
constexpr int kSlipSteps = 8;

// What the nodes of an element know, blended at a place.
struct Friction {
  Real coefficient = 0.0;
  Real presliding_m = 0.0;
  Real depth_m = 0.0;               // past the touch
  bool lateral = true;              // every node with a weight knows S
  Matrix3 share = Matrix3::Zero();  // sum_j w_j S_j
};

Matrix3 lateral_of(const ElementNode& node, Real depth_share) {
  const auto at = BetweenDepths<Real>::at(depth_share);
  Matrix2 S;
  S << at.of(node.lateral, 3, 0), at.of(node.lateral, 3, 1), at.of(node.lateral, 3, 1),
      at.of(node.lateral, 3, 2);
  const Frame frame = tangent_frame(Vector3(node.normal.data()));
  return frame * S * frame.transpose();
}

Friction blended(const FieldPlace& place, const Element& element, Real depth_m) {
  Friction friction;
  for (std::size_t j = 0; j < 3; ++j) {
    const Real weight = weight_of(place, j);
    const ElementNode& node = element.node[j];
    friction.coefficient += weight * node.friction;
    friction.presliding_m += weight * node.presliding_m;
    if (!(weight > 0.0) || node.samples == 0) {
      continue;
    }
    if (!(node.lateral[0] > 0.0)) {
      friction.lateral = false;
      continue;
    }
    const Real last_m = node.depth_m[static_cast<std::size_t>(node.samples) - 1];
    const Real past_m = std::max(Real(0.0), depth_m - node.touch_offset_m);
    friction.depth_m += weight * past_m;
    friction.share += weight * lateral_of(node, past_m / last_m);
  }
  friction.lateral = friction.lateral && friction.depth_m > 0.0;
  return friction;
}

// Into the plane, as long as it was.
void turn_into(const Vector3& normal, Vector3& stretch_m) {
  const Real length2 = stretch_m.squaredNorm();
  stretch_m -= stretch_m.dot(normal) * normal;
  const Real in_plane2 = stretch_m.squaredNorm();
  if (in_plane2 > 0.0) {
    stretch_m *= std::sqrt(length2 / in_plane2);
  }
}

// The stretch of which K's force is at most `most_n`: the nearest to t in K's measure.
// With c the eigenvalues of K^-1 and q the force, (c + s) q = t; |q| falls with s.
Eigen::Matrix<Real, 2, 1> slipped(const Matrix2& K, const Eigen::Matrix<Real, 2, 1>& t,
                                  Real most_n) {
  const Eigen::Matrix<Real, 2, 1> trial = K * t;
  if (!(trial.squaredNorm() > most_n * most_n)) {
    return t;
  }
  if (!(most_n > 0.0)) {
    return Eigen::Matrix<Real, 2, 1>::Zero();
  }
  const Matrix2 C = K.inverse();
  Real s = 0.0;
  Eigen::Matrix<Real, 2, 1> q = trial;
  for (int i = 0; i < kSlipSteps; ++i) {
    const Real length = q.norm();
    if (!(length > most_n * (Real(1.0) + rounding(1e-12, 1e-5)))) {
      break;
    }
    const Matrix2 at = (C + s * Matrix2::Identity()).inverse();
    s += length * length / q.dot(at * q) * (length - most_n) / most_n;
    q = (C + s * Matrix2::Identity()).inverse() * t;
  }
  return C * (q * std::min(Real(1.0), most_n / q.norm()));
}

void set_by_body(FrictionSpring& spring, const FieldPlace& place,
                 const Friction& friction, Real normal_n) {
  const Real before_j = spring.energy_j();
  const Frame frame = tangent_frame(place.normal);
  const Matrix2 K =
      normal_n / friction.depth_m * (frame.transpose() * friction.share * frame);
  spring.by_body = true;
  spring.n_per_m = Real(0.5) * K.trace();
  spring.tensor_n_per_m = frame * K * frame.transpose();
  if (!(spring.stretch_m.squaredNorm() > 0.0)) {
    return;
  }
  turn_into(place.normal, spring.stretch_m);
  const Real after_j = spring.energy_j();
  if (after_j > before_j) {
    spring.stretch_m *= std::sqrt(before_j / after_j);  // (23)
  }
  spring.stretch_m = frame * slipped(K, frame.transpose() * spring.stretch_m,
                                     friction.coefficient * normal_n);
}

}  // namespace

void set_spring(FrictionSpring& spring, const FieldPlace& place,
                const ElementCache& cache, Real depth_m, Real normal_n) noexcept {
  const Friction friction =
      blended(place, cache.element[static_cast<std::size_t>(place.slot)], depth_m);
  if (!(friction.coefficient > 0.0 && friction.presliding_m > 0.0)) {
    spring = {};
    return;
  }
  const Real pressed_n = std::max(Real(0.0), normal_n);
  spring.limit_n = friction.coefficient * pressed_n;
  if (friction.lateral) {
    set_by_body(spring, place, friction, pressed_n);
    return;
  }
  if (spring.by_body) {  // it goes on as a spring alike in all directions
    const Real length2 = spring.stretch_m.squaredNorm();
    spring.n_per_m = length2 > 0.0 ? 2.0 * spring.energy_j() / length2 : Real(0.0);
    spring.by_body = false;
  }
  const Real before = spring.n_per_m;
  const Real now = spring.limit_n / friction.presliding_m;
  spring.n_per_m = now;
  Vector3& t = spring.stretch_m;
  const Real length2 = t.squaredNorm();
  if (!(length2 > 0.0)) {
    return;
  }
  const Vector3& n = place.normal;
  t -= t.dot(n) * n;
  const Real in_plane2 = t.squaredNorm();
  const Real kept2 = now > before ? length2 * before / now : length2;  // (23)
  const Real limit2 = friction.presliding_m * friction.presliding_m;
  if (in_plane2 > 0.0) {
    t *= std::sqrt(std::min(kept2, limit2) / in_plane2);
  }
}

}  // namespace palpate
