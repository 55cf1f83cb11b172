#include "runtime/element/smooth_triangle.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <Eigen/Geometry>

namespace palpate {
namespace {

using Index = Eigen::Index;

// Shares of two corners below which a place is on the third one's line: its weights are
// off by the square, its force by the share; above, rounding turns the force by epsilon
// / share. Both are equal at about sqrt(epsilon).
constexpr Real kOnNodeLine = rounding(1e-9, 3e-4);

EdgeValues dot(const EdgeVectors& a, const EdgeVectors& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

EdgeVectors plus(const EdgeVectors& a, const EdgeValues& s, const EdgeVectors& b) {
  return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

EdgeVectors times(const EdgeValues& s, const EdgeVectors& a) {
  return {s * a.x, s * a.y, s * a.z};
}

// H, eps and their derivatives at t, held in [0, 1].
struct Along {
  Real step = 0.0;        // H
  Real step_slope = 0.0;  // H'
  Real bump = 0.0;        // eps
  Real bump_slope = 0.0;  // eps'
};

Along along_edge(Real t) {
  const Real held = std::clamp(t, Real(0.0), Real(1.0));
  const Real z = held * (1.0 - held);
  return {held * held * (3.0 - 2.0 * held), 6.0 * z, 2.0 * z * z,
          4.0 * z * (1.0 - 2.0 * held)};
}

// A function's derivatives by t_i and beta_i.
struct Rates {
  Vector3 by_along = Vector3::Zero();
  Vector3 by_offset = Vector3::Zero();
};

// Scalar by scalar: sides were made by pairs, which costs more to take apart in memory.
Vector3 gradient_of(const Rates& rates, const SmoothSides& sides) {
  const EdgeVectors& t = sides.along_gradient;
  const EdgeVectors& beta = sides.offset_gradient;
  Vector3 sum = Vector3::Zero();
  for (Index i = 0; i < 3; ++i) {
    sum += rates.by_along(i) * t.at(i) + rates.by_offset(i) * beta.at(i);
  }
  return sum;
}

// r_j at a height.
Vector3 rise_at(const SmoothTriangle& t, Index j, Real s) {
  return t.rise.col(j) + s * t.rise_by_height_per_m.col(j);
}

// @returns whether the height's equation is sound.
bool set_on_line(const SmoothTriangle& t, Index corner, const Vector3& x,
                 SmoothPoint& point) {
  const Vector3 y = x - t.corner_m.col(corner);
  const Real under = 1.0 - t.rise_by_height_per_m.col(corner).dot(y);
  if (!(under > kStretchMin)) {
    return false;
  }
  point = {};
  point.weight(corner) = 1.0;
  point.height_m = t.rise.col(corner).dot(y) / under;
  point.rise = rise_at(t, corner, point.height_m) / under;
  return true;
}

// Values of a blend, which its derivatives need.
struct Blend {
  Real per_sum = 0.0;    // of the shares
  Vector3 share;         // b
  Real per_pairs = 0.0;  // of the squares (b_j b_k)^2
  Vector3 side_weight;   // W
  std::array<Along, 3> along;
  Vector3 own_m;         // the height by each node's plane: p_j . (x - v_j)
  Vector3 own;           // and q_j . (x - v_j)
  Real per_under = 0.0;  // of the height's denominator
};

void weigh_sides(const SmoothSides& sides, Blend& blend, Vector3& node_weight) {
  const Vector3& b = blend.share;
  const Vector3 pair(b(1) * b(2), b(2) * b(0), b(0) * b(1));
  blend.per_pairs = 1.0 / pair.squaredNorm();
  blend.side_weight = blend.per_pairs * pair.cwiseAbs2();
  node_weight.setZero();
  for (Index i = 0; i < 3; ++i) {
    // Side i gives its end k a part, and its other end j the rest.
    const Along at = along_edge(sides.along(i));
    blend.along[static_cast<std::size_t>(i)] = at;
    const Index j = after(i);
    node_weight(after(j)) += blend.side_weight(i) * at.step;
    node_weight(j) += blend.side_weight(i) * (1.0 - at.step);
  }
}

// @returns whether the height's equation is sound.
bool set_height(const SmoothTriangle& triangle, const SmoothSides& sides,
                const Vector3& x, Blend& blend, SmoothPoint& point) {
  const SmoothEdges& edges = triangle.edges;
  // s = over_m / under of the header: twist is tau, gap gamma and sag kappa, each with
  // its part by height, which the header marks by a prime. over is (t_i - H) beta_i
  // [m].
  Real over_m = 0.0;
  Real under = 1.0;
  for (Index i = 0; i < 3; ++i) {
    const Along& at = blend.along[static_cast<std::size_t>(i)];
    const Real w = blend.side_weight(i);
    const Real r = 0.5 * blend.share(i) * blend.share(i);
    const Real over = (sides.along(i) - at.step) * sides.offset_m(i);
    over_m +=
        w * (over * edges.twist(i) - at.bump * edges.gap_m(i) - r * edges.sag_m(i));
    under -= w * (over * edges.twist_by_height_per_m(i) + at.bump * edges.gap(i) +
                  r * edges.sag(i));
  }
  for (Index j = 0; j < 3; ++j) {
    const Vector3 y = x - triangle.corner_m.col(j);
    blend.own_m(j) = triangle.rise.col(j).dot(y);
    blend.own(j) = triangle.rise_by_height_per_m.col(j).dot(y);
  }
  under -= point.weight.dot(blend.own);
  if (!(under > kStretchMin)) {
    return false;
  }
  blend.per_under = 1.0 / under;
  point.height_m = blend.per_under * (over_m + point.weight.dot(blend.own_m));
  return true;
}

// Derivatives of w_0, w_1 and s by t_i and beta_i, as far as W stays.
struct SideRates {
  std::array<Rates, 2> of_weight;
  Rates of_height;
  Matrix3 given = Matrix3::Zero();  // (function x side) value of each at W_i = 1
};

SideRates side_rates(const SmoothTriangle& triangle, const SmoothSides& sides,
                     const Blend& blend, Real s) {
  const SmoothEdges& edges = triangle.edges;
  // With r_j = p_j + s q_j the height is s = sum_i W_i h_i, side i having
  //   h_i = (1 - H) r_j.(x - v_j) + H r_k.(x - v_k) + (t_i - H) beta_i (tau + s tau')
  //         - eps (gamma - s gamma') - b_i^2 (kappa - s kappa') / 2
  // given(2, i) is h_i. of_height has W_i dh_i/dt_i and W_i dh_i/dbeta_i at held s, b_i
  // and x. Only w_0 and w_1 are kept, because weights sum to one.
  const Vector3 own_m = blend.own_m + s * blend.own;
  SideRates rates;
  for (Index i = 0; i < 3; ++i) {
    const Along& at = blend.along[static_cast<std::size_t>(i)];
    const Index j = after(i);
    const Index k = after(j);
    const Real b = blend.share(i);
    const Real w = blend.side_weight(i);
    const Real gap_m = edges.gap_m(i) - s * edges.gap(i);
    const Real sag_m = edges.sag_m(i) - s * edges.sag(i);
    const Real twist = edges.twist(i) + s * edges.twist_by_height_per_m(i);
    const Real twisted_m = sides.offset_m(i) * twist;
    const Real over = sides.along(i) - at.step;
    if (k < 2) {
      rates.given(k, i) = at.step;
      rates.of_weight[static_cast<std::size_t>(k)].by_along(i) = w * at.step_slope;
    }
    if (j < 2) {
      rates.given(j, i) = 1.0 - at.step;
      rates.of_weight[static_cast<std::size_t>(j)].by_along(i) = -w * at.step_slope;
    }
    rates.given(2, i) = over * twisted_m - at.bump * gap_m - 0.5 * b * b * sag_m +
                        own_m(j) + at.step * (own_m(k) - own_m(j));
    rates.of_height.by_along(i) =
        w * (at.step_slope * (own_m(k) - own_m(j)) + (1.0 - at.step_slope) * twisted_m -
             at.bump_slope * gap_m);
    rates.of_height.by_offset(i) = w * over * twist;
  }
  return rates;
}

// With the squares q_i = (b_j b_k)^2, which are in all of them:
// dW_i = (dq_i - W_i sum dq) / sum q.
void set_gradients(const SmoothTriangle& triangle, const SmoothSides& sides,
                   const Blend& blend, SmoothPoint& point) {
  const SmoothEdges& edges = triangle.edges;
  const Vector3& b = blend.share;
  SideRates rates = side_rates(triangle, sides, blend, point.height_m);
  const Vector3 mean = rates.given * blend.side_weight;
  Matrix3 by_share;  // (function x corner) derivative by b
  for (Index l = 0; l < 3; ++l) {
    const Index m = after(l);
    const Index o = after(m);
    // b_l is in q_m, with b_o, and in q_o, with b_m.
    by_share.col(l) =
        (2.0 * blend.per_pairs * b(l)) * (b(o) * b(o) * (rates.given.col(m) - mean) +
                                          b(m) * b(m) * (rates.given.col(o) - mean));
    by_share(2, l) -=
        blend.side_weight(l) * b(l) * (edges.sag_m(l) - point.height_m * edges.sag(l));
  }
  const Vector3 common = by_share * b;  // b sums to one
  for (Index i = 0; i < 3; ++i) {
    const Real rate = blend.per_sum * edges.per_altitude_m(i);
    rates.of_weight[0].by_offset(i) = rate * (by_share(0, i) - common(0));
    rates.of_weight[1].by_offset(i) = rate * (by_share(1, i) - common(1));
    rates.of_height.by_offset(i) += rate * (by_share(2, i) - common(2));
  }
  point.turn.row(0) = gradient_of(rates.of_weight[0], sides);
  point.turn.row(1) = gradient_of(rates.of_weight[1], sides);
  point.turn.row(2) = -point.turn.row(0) - point.turn.row(1);
  const Matrix3 rise = triangle.rise + point.height_m * triangle.rise_by_height_per_m;
  point.rise =
      blend.per_under * (rise * point.weight + gradient_of(rates.of_height, sides));
}

// The edge beyond which x lies and along which it has its foot; else, beyond a corner,
// the one whose end is nearest; -1 where none is sound.
Index edge_towards(const SmoothEdges& edges, const SmoothSides& sides) {
  Index i = -1;
  Real nearest = 0.0;
  for (Index edge = 0; edge < 3; ++edge) {
    if (!sides.sound[static_cast<std::size_t>(edge)] ||
        !(sides.altitudes(edge) < 0.0)) {
      continue;
    }
    const Real t = sides.along(edge);
    const Real past =
        std::max({-t, t - Real(1.0), Real(0.0)}) * edges.edge_m.at(edge).norm();
    if (i < 0 || past < nearest) {
      i = edge;
      nearest = past;
    }
  }
  return i;
}

}  // namespace

SmoothSides sides_at(const SmoothTriangle& triangle, const Vector3& x_m) noexcept {
  const SmoothEdges& edges = triangle.edges;
  const EdgeVectors y{x_m.x() - edges.start_m.x, x_m.y() - edges.start_m.y,
                      x_m.z() - edges.start_m.z};
  // A + B t + C t^2 = 0, the root that stays finite where C goes to zero.
  const EdgeValues a = dot(y, edges.turned);
  const EdgeValues b = dot(y, edges.turning) - edges.open_m;
  const EdgeValues discriminant = b * b + 4.0 * a * edges.closing_m;
  const EdgeValues least = kStretchMin * edges.open_m;
  const EdgeValues root = discriminant.max(least * least).sqrt();
  SmoothSides at;
  at.along = 2.0 * a / (root - b);
  at.along_gradient =
      times(root.inverse(), plus(edges.turned, at.along, edges.turning));
  // beta of the two equations by m and N, and its derivative by t.
  const EdgeVectors normal = plus(edges.normal, at.along, edges.bend);
  const EdgeVectors r = plus(y, -at.along, edges.edge_m);
  const EdgeValues rm = dot(r, edges.across);
  const EdgeValues rn = dot(r, normal);
  const EdgeValues mn = edges.across_normal + at.along * edges.across_bend;
  const EdgeValues nd = edges.normal_bend + at.along * edges.bend_squared;
  const EdgeValues nn = edges.normal_squared + at.along * (edges.normal_bend + nd);
  const EdgeValues apart = nn - mn * mn;  // of m and N: their planes' stretch
  const EdgeValues inverse = apart.inverse();
  const EdgeValues beta = inverse * (rm * nn - rn * mn);
  const EdgeValues by_along =
      inverse * ((edges.edge_normal_m + at.along * edges.edge_bend_m) * mn +
                 2.0 * nd * (rm - beta) - dot(r, edges.bend) * mn -
                 (rn - 2.0 * beta * mn) * edges.across_bend);
  at.offset_m = beta;
  at.altitudes = beta * edges.per_altitude_m;
  at.offset_gradient =
      plus(plus(times(inverse * nn, edges.across), -inverse * mn, normal), by_along,
           at.along_gradient);
  for (Index i = 0; i < 3; ++i) {
    const bool sound = least(i) > 0.0 && b(i) < 0.0 &&
                       discriminant(i) > least(i) * least(i) &&
                       apart(i) > kStretchMin * kStretchMin;
    at.sound[static_cast<std::size_t>(i)] = sound;
    at.altitudes(i) = sound ? at.altitudes(i) : Real(0.0);
  }
  return at;
}

bool set_inside(const SmoothTriangle& triangle, const SmoothSides& sides,
                const Vector3& x_m, SmoothPoint& point) noexcept {
  const Real sum = sides.altitudes.head<3>().sum();
  if (!(sides.sound[0] && sides.sound[1] && sides.sound[2] && sum > kStretchMin)) {
    return false;
  }
  Blend blend;
  blend.per_sum = 1.0 / sum;
  blend.share = blend.per_sum * sides.altitudes.head<3>().matrix();
  Index corner = 0;
  if (blend.share.maxCoeff(&corner) > 1.0 - kOnNodeLine) {
    return set_on_line(triangle, corner, x_m, point);
  }
  weigh_sides(sides, blend, point.weight);
  if (!set_height(triangle, sides, x_m, blend, point)) {
    return false;
  }
  set_gradients(triangle, sides, blend, point);
  return true;
}

bool set_beyond(const SmoothTriangle& triangle, const SmoothSides& sides,
                const Vector3& x_m, SmoothPoint& point) noexcept {
  const SmoothEdges& edges = triangle.edges;
  const Index i = edge_towards(edges, sides);
  if (i < 0) {
    return false;
  }
  const Index j = after(i);
  const Index k = after(j);
  // Beyond a corner the tangent plane of that corner goes on.
  if (!(sides.along(i) > 0.0 && sides.along(i) < 1.0)) {
    return set_on_line(triangle, sides.along(i) > 0.0 ? k : j, x_m, point);
  }
  // Beyond edge i: the equation of s with W_i = 1 and b_i = 0, where the third corner
  // and kappa take no part. own, more: q_j . (x - v_j), and what q_k . (x - v_k)
  // exceeds it by; own_m, more_m: the same of p.
  const Along at = along_edge(sides.along(i));
  const Vector3 y_j = x_m - triangle.corner_m.col(j);
  const Vector3 y_k = x_m - triangle.corner_m.col(k);
  const auto between = [&](const Matrix3& of) {
    const Real first = of.col(j).dot(y_j);
    return std::pair(first, of.col(k).dot(y_k) - first);
  };
  const auto [own_m, more_m] = between(triangle.rise);
  const auto [own, more] = between(triangle.rise_by_height_per_m);
  const Real over = sides.along(i) - at.step;
  const Real beta = sides.offset_m(i);
  const Real twisting = over * beta * edges.twist_by_height_per_m(i);
  const Real under = 1.0 - own - at.step * more - twisting - at.bump * edges.gap(i);
  if (!(under > kStretchMin)) {
    return false;
  }
  const Real per_under = 1.0 / under;
  const Real s = per_under * (own_m + at.step * more_m + over * beta * edges.twist(i) -
                              at.bump * edges.gap_m(i));
  const Real twist = edges.twist(i) + s * edges.twist_by_height_per_m(i);
  // By t_i at held s: H' of the planes, 1 - H' of the twist and eps' of the gap; by
  // beta_i: (t_i - H) (tau + s tau'). per_under divides, because s is on both sides.
  const Real by_along = at.step_slope * (more_m + s * more) +
                        (1.0 - at.step_slope) * beta * twist -
                        at.bump_slope * (edges.gap_m(i) - s * edges.gap(i));
  point = {};
  point.weight(j) = 1.0 - at.step;
  point.weight(k) = at.step;
  point.turn.row(k) = at.step_slope * sides.along_gradient.at(i);
  point.turn.row(j) = -point.turn.row(k);
  point.height_m = s;
  point.rise =
      per_under * ((triangle.rise + s * triangle.rise_by_height_per_m) * point.weight +
                   by_along * sides.along_gradient.at(i) +
                   (over * twist) * sides.offset_gradient.at(i));
  return true;
}

}  // namespace palpate
