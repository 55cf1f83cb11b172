#include "runtime/element/prism.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "runtime/element/triangle.h"

namespace palpate {
namespace {

constexpr int kNewtonMax = 12;
// A step this small, in area coordinates and edges, is the last: Newton's method
// squares it.
constexpr Real kLastStep = rounding(1e-7, 1e-4);
// And one that moves a point by this much of its distance from the origin.
constexpr Real kPlaceRounding = rounding(4e-16, 2e-7);
// A step longer than this, likewise, is not followed.
constexpr Real kFarOut = 16.0;

// Weights at the nearest point of the triangle, and how they turn with n.
void hold(const Prism& prism, const Vector3& area, PrismFrame& frame) {
  const Matrix3& v = prism.corner_m;
  frame.weight = triangle::nearest_inside(v, area);
  frame.turn.setZero();
  int out = 0;
  if (frame.weight.minCoeff(&out) > 0.0) {
    return;
  }
  const int j = (out + 1) % 3;
  const int k = (out + 2) % 3;
  if (!(frame.weight(j) > 0.0 && frame.weight(k) > 0.0)) {
    return;  // at a corner
  }
  const Vector3 edge = v.col(k) - v.col(j);
  for (int i = 0; i < 2; ++i) {
    const Real along = (v.col(i + 1) - v.col(0)).dot(edge) / edge.squaredNorm();
    frame.turn(j, i) = -along;
    frame.turn(k, i) = along;
  }
}

// What one step of Newton's method changes.
struct PrismStep {
  Real d1 = 0.0;
  Real d2 = 0.0;
  Real ds_m = 0.0;
};

PrismStep solve(const PrismFrame& frame, const Vector3& r_m) {
  const Real inverse = frame.inverse_per_m2;
  const Vector3 turned_r = frame.normal.cross(r_m);
  return {inverse * frame.along2_m.dot(turned_r),
          -inverse * frame.along1_m.dot(turned_r), inverse * r_m.dot(frame.cross_m2)};
}

Real apply(const PrismStep& step, Real size_m, PrismPoint& at) {
  at.area(0) -= step.d1 + step.d2;
  at.area(1) += step.d1;
  at.area(2) += step.d2;
  at.height_m += step.ds_m;
  return std::max({std::abs(step.d1), std::abs(step.d2), std::abs(step.ds_m) / size_m});
}

// dn_out and d ln|N| by n_i, from dN.
void bend(const PrismFrame& frame, const Vector3& dn, Real inverse, Vector3& normal,
          Real& growth) {
  const Real along = dn.dot(frame.normal);
  normal = inverse * (dn - along * frame.normal);
  growth = inverse * along;
}

}  // namespace

Prism make_prism(const Element& element) noexcept {
  Prism prism;
  for (std::size_t j = 0; j < 3; ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    const ElementNode& node = element.node[j];
    prism.corner_m.col(column) = Eigen::Map<const Vector3>(node.position_m.data());
    prism.normal.col(column) = Eigen::Map<const Vector3>(node.normal.data());
  }
  const Vector3 e1 = prism.corner_m.col(1) - prism.corner_m.col(0);
  const Vector3 e2 = prism.corner_m.col(2) - prism.corner_m.col(0);
  prism.doubled_area_m2 = e1.cross(e2).norm();
  prism.size_m = std::sqrt(prism.doubled_area_m2);
  prism.flat = triangle::flat(e1, e2);
  return prism;
}

void set_frame(const Prism& prism, const PrismPoint& at, Beyond beyond,
               PrismFrame& frame) noexcept {
  const Matrix3& v = prism.corner_m;
  const Matrix3& n = prism.normal;
  // turn1 and turn2 are dN/dn_1 and dN/dn_2, n_0 compensating: n_1 - n_0 and n_2 - n_0
  // by the same formula. Held weights turn with their nearest point.
  Vector3 turn1;
  Vector3 turn2;
  if (beyond == Beyond::kAnalytic || at.area.minCoeff() >= 0.0) {
    frame.weight = at.area;
    frame.turn << -1.0, -1.0, 1.0, 0.0, 0.0, 1.0;
    turn1 = n.col(1) - n.col(0);
    turn2 = n.col(2) - n.col(0);
  } else {
    hold(prism, at.area, frame);
    turn1 = n * frame.turn.col(0);
    turn2 = n * frame.turn.col(1);
  }
  const Vector3 sum = n * frame.weight;
  const Real length = sum.norm();
  // Without area or normal there are no coordinates: scale stays 0, below kScaleMin.
  if (prism.flat || !(length > kNoNormal)) {
    const Vector3 weight = frame.weight;
    const Eigen::Matrix<Real, 3, 2> turn = frame.turn;
    frame = {.weight = weight, .turn = turn};
    return;
  }
  const Real inverse = 1.0 / length;
  // x = sum n_j v_j + s N / |N|, and dx/dn_i = v_i - v_0 + s dn_out/dn_i.
  frame.normal = inverse * sum;
  bend(frame, turn1, inverse, frame.bend1, frame.growth(0));
  bend(frame, turn2, inverse, frame.bend2, frame.growth(1));
  frame.position_m = v * at.area + at.height_m * frame.normal;
  frame.along1_m = v.col(1) - v.col(0) + at.height_m * frame.bend1;
  frame.along2_m = v.col(2) - v.col(0) + at.height_m * frame.bend2;
  // Determinant of (dx/dn_1, dx/dn_2, dx/ds), which is dx/dn_1 x dx/dn_2 . n_out.
  frame.cross_m2 = frame.along1_m.cross(frame.along2_m);
  const Real determinant_m2 = frame.cross_m2.dot(frame.normal);
  frame.inverse_per_m2 = 1.0 / determinant_m2;
  frame.scale = determinant_m2 / prism.doubled_area_m2;
}

Real newton_step(const PrismFrame& frame, const Vector3& r_m, Real size_m,
                 PrismPoint& at) noexcept {
  return apply(solve(frame, r_m), size_m, at);
}

void predict(const PrismFrame& frame, const Vector3& r_m, Real size_m,
             PrismPoint& at) noexcept {
  const PrismStep first = solve(frame, r_m);
  const Vector3 tau = first.d1 * frame.bend1 + first.d2 * frame.bend2;
  const Real growth = first.d1 * frame.growth(0) + first.d2 * frame.growth(1);
  const Vector3 q = (first.ds_m - at.height_m * growth) * tau -
                    (0.5 * at.height_m * tau.squaredNorm()) * frame.normal;
  (void)apply(solve(frame, r_m - q), size_m, at);
}

PrismSolve find_coordinates(const Prism& prism, const Vector3& x_m, Beyond beyond,
                            PrismPoint& at, PrismFrame& frame) noexcept {
  const Real rounding_m = kPlaceRounding * (x_m.cwiseAbs().maxCoeff() + prism.size_m);
  for (int i = 0; i < kNewtonMax; ++i) {
    set_frame(prism, at, beyond, frame);
    if (!(frame.scale > kScaleMin)) {
      return PrismSolve::kFolded;
    }
    const Vector3 r = x_m - frame.position_m;
    const Real step = newton_step(frame, r, prism.size_m, at);
    if (step <= kLastStep || r.cwiseAbs().maxCoeff() <= rounding_m) {
      frame.position_m = x_m;
      return PrismSolve::kFound;
    }
    if (!(step <= kFarOut)) {
      return PrismSolve::kFolded;
    }
  }
  return PrismSolve::kFolded;
}

Vector3 gradient(const PrismFrame& frame, Real by_n1, Real by_n2,
                 Real by_s_per_m) noexcept {
  return frame.inverse_per_m2 *
         ((by_n1 * frame.along2_m - by_n2 * frame.along1_m).cross(frame.normal) +
          by_s_per_m * frame.cross_m2);
}

}  // namespace palpate
