#include "runtime/fast/smooth_triangle.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

namespace palpate {
namespace {

using Index = Eigen::Index;

// Shares of two corners below which a place is on the third one's line: its weights are
// off by the square.
constexpr Real kOnNodeLine = rounding(1e-9, 1e-5);

Index after(Index i) {
  return i == 2 ? 0 : i + 1;
}

const SmoothSide& side_of(const SmoothTriangle& triangle, Index i) {
  return triangle.side[static_cast<std::size_t>(i)];
}

// What the edge alone fixes.
SmoothSide make_side(const SmoothTriangle& t, Index i) {
  const Index j = after(i);
  const Index k = after(j);
  const Vector3 n = t.normal.col(j);
  SmoothSide side;
  side.edge_m = t.corner_m.col(k) - t.corner_m.col(j);
  side.bend = t.normal.col(k) - n;
  const Vector3 across = (n + t.normal.col(k)).cross(side.edge_m);
  const Real length = across.norm();
  side.across = length > 0.0 ? Vector3(across / length) : Vector3::Zero();
  side.turned = side.across.cross(n);
  side.turning = side.across.cross(side.bend);
  side.open_m = side.edge_m.dot(side.turned);
  side.closing_m = side.edge_m.dot(side.turning);
  side.edge_normal_m = side.edge_m.dot(n);
  side.edge_bend_m = side.edge_m.dot(side.bend);
  side.across_normal = side.across.dot(n);
  side.across_bend = side.across.dot(side.bend);
  side.normal_squared = n.squaredNorm();
  side.normal_bend = n.dot(side.bend);
  side.bend_squared = side.bend.squaredNorm();
  const Real area =
      side.edge_m.cross(Vector3(t.corner_m.col(i) - t.corner_m.col(j))).norm();
  side.per_altitude_m = area > 0.0 ? side.edge_m.norm() / area : Real(0.0);
  const Vector3 fall = t.rise.col(j) - t.rise.col(k);
  side.gap_m = fall.dot(side.edge_m);
  side.gap = -fall.dot(side.bend);
  side.twist = -fall.dot(side.across);
  return side;
}

// The three gammas are the height's second differences along the edges; kappa is that
// towards corner i, u the foot of its altitude.
void set_sag(SmoothTriangle& t, Index i) {
  const Index j = after(i);
  const Index k = after(j);
  SmoothSide& side = t.side[static_cast<std::size_t>(i)];
  const SmoothSide& to_k = side_of(t, k);  // the edge from i to j
  const SmoothSide& to_j = side_of(t, j);  // the edge from k to i
  const Vector3 up = t.corner_m.col(i) - t.corner_m.col(j);
  const Real length2 = side.edge_m.squaredNorm();
  const Real u = length2 > 0.0 ? up.dot(side.edge_m) / length2 : Real(0.0);
  side.sag_m = (1.0 - u) * to_k.gap_m + u * to_j.gap_m - u * (1.0 - u) * side.gap_m;
  side.sag = (1.0 - u) * to_k.gap + u * to_j.gap - u * (1.0 - u) * side.gap;
}

void set_side(const SmoothTriangle& t, Index i, const Vector3& x, SmoothSides& at) {
  const Index j = after(i);
  const SmoothSide& side = side_of(t, i);
  const Vector3 y = x - t.corner_m.col(j);
  // A + B t + C t^2 = 0, the root that stays finite where C goes to zero.
  const Real a = y.dot(side.turned);
  const Real b = y.dot(side.turning) - side.open_m;
  const Real discriminant = b * b + 4.0 * a * side.closing_m;
  const Real least = kStretchMin * side.open_m;
  if (!(least > 0.0 && b < 0.0 && discriminant > least * least)) {
    return;
  }
  const Real root = std::sqrt(discriminant);
  const Real along = 2.0 * a / (root - b);
  const Vector3 along_gradient = (side.turned + along * side.turning) / root;
  // beta of the two equations by m and N, and its derivative by t.
  const Vector3 normal = t.normal.col(j) + along * side.bend;
  const Vector3 r = y - along * side.edge_m;
  const Real rm = r.dot(side.across);
  const Real rn = r.dot(normal);
  const Real mn = side.across_normal + along * side.across_bend;
  const Real nd = side.normal_bend + along * side.bend_squared;
  const Real nn = side.normal_squared + along * (side.normal_bend + nd);
  const Real inverse = 1.0 / (nn - mn * mn);
  const Real beta = inverse * (rm * nn - rn * mn);
  const Real by_along =
      inverse *
      ((side.edge_normal_m + along * side.edge_bend_m) * mn + 2.0 * nd * (rm - beta) -
       r.dot(side.bend) * mn - (rn - 2.0 * beta * mn) * side.across_bend);
  at.along(i) = along;
  at.offset_m(i) = beta;
  at.altitudes(i) = beta * side.per_altitude_m;
  at.along_gradient.col(i) = along_gradient;
  at.offset_gradient.col(i) = (inverse * nn) * side.across - (inverse * mn) * normal +
                              by_along * along_gradient;
  at.sound[static_cast<std::size_t>(i)] = inverse > 0.0 && std::isfinite(beta);
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

Vector3 gradient_of(const Rates& rates, const SmoothSides& sides) {
  return sides.along_gradient * rates.by_along +
         sides.offset_gradient * rates.by_offset;
}

void set_on_line(const SmoothTriangle& t, Index corner, const Vector3& x,
                 SmoothPoint& point) {
  point = {};
  point.weight(corner) = 1.0;
  point.rise = t.rise.col(corner);
  point.height_m = point.rise.dot(x - t.corner_m.col(corner));
}

// The parts of the height that edge i adds where its weight is 1.
struct EdgeHeight {
  Real over_m = 0.0;  // to the numerator
  Real under = 0.0;   // to the denominator
};

}  // namespace

Vector3 rise_of(const ElementNode& node) noexcept {
  const Eigen::Map<const Vector3> n(node.normal.data());
  const Eigen::Map<const Vector3> u(node.direction.data());
  const Real up = std::abs(u.dot(n));
  const Vector3 lean = u - u.dot(n) * n;
  const Real least = std::max(up, lean.norm());
  return node.samples > 0 && least > 0.0 ? Vector3(n + lean / least) : Vector3(n);
}

SmoothTriangle make_smooth_triangle(const Element& element) noexcept {
  SmoothTriangle triangle;
  for (std::size_t j = 0; j < 3; ++j) {
    const auto column = static_cast<Index>(j);
    const ElementNode& node = element.node[j];
    triangle.corner_m.col(column) = Eigen::Map<const Vector3>(node.position_m.data());
    triangle.normal.col(column) = Eigen::Map<const Vector3>(node.normal.data());
    triangle.rise.col(column) = rise_of(node);
  }
  for (Index i = 0; i < 3; ++i) {
    triangle.side[static_cast<std::size_t>(i)] = make_side(triangle, i);
  }
  for (Index i = 0; i < 3; ++i) {
    set_sag(triangle, i);
  }
  return triangle;
}

SmoothSides sides_at(const SmoothTriangle& triangle, const Vector3& x_m) noexcept {
  SmoothSides sides;
  for (Index i = 0; i < 3; ++i) {
    set_side(triangle, i, x_m, sides);
  }
  return sides;
}

bool set_inside(const SmoothTriangle& triangle, const SmoothSides& sides,
                const Vector3& x_m, SmoothPoint& point) noexcept {
  const Real sum = sides.altitudes.sum();
  if (!(sides.sound[0] && sides.sound[1] && sides.sound[2] && sum > kStretchMin)) {
    return false;
  }
  const Real per_sum = 1.0 / sum;
  const Vector3 b = per_sum * sides.altitudes;
  Index corner = 0;
  if (b.maxCoeff(&corner) > 1.0 - kOnNodeLine) {
    set_on_line(triangle, corner, x_m, point);
    return true;
  }
  // W_i and what side i gives its end k; its other end j has the rest.
  const Vector3 pair(b(1) * b(2), b(2) * b(0), b(0) * b(1));
  const Real per_pairs = 1.0 / pair.squaredNorm();
  const Vector3 weight = per_pairs * pair.cwiseAbs2();
  std::array<Along, 3> along;
  Vector3 w = Vector3::Zero();
  Real over_m = 0.0;
  Real under = 1.0;
  for (Index i = 0; i < 3; ++i) {
    const SmoothSide& side = side_of(triangle, i);
    const Along& at = along[static_cast<std::size_t>(i)] = along_edge(sides.along(i));
    const Index j = after(i);
    w(after(j)) += weight(i) * at.step;
    w(j) += weight(i) * (1.0 - at.step);
    const Real r = 0.5 * b(i) * b(i);
    over_m += weight(i) * ((sides.along(i) - at.step) * sides.offset_m(i) * side.twist -
                           at.bump * side.gap_m - r * side.sag_m);
    under -= weight(i) * (at.bump * side.gap + r * side.sag);
  }
  if (!(under > kStretchMin)) {
    return false;
  }
  Vector3 own_m;  // the height by each node's plane
  for (Index j = 0; j < 3; ++j) {
    own_m(j) = triangle.rise.col(j).dot(x_m - triangle.corner_m.col(j));
  }
  const Real per_under = 1.0 / under;
  const Real s = per_under * (over_m + w.dot(own_m));

  // Derivatives of w_0, w_1 and s by t_i and beta_i. The squares q_i = (b_j b_k)^2 are
  // in all of them: dW_i = (dq_i - W_i sum dq) / sum q.
  std::array<Rates, 2> of_weight;
  Rates of_height;
  Matrix3 given = Matrix3::Zero();  // (function x side) value of each at W_i = 1
  for (Index i = 0; i < 3; ++i) {
    const SmoothSide& side = side_of(triangle, i);
    const Along& at = along[static_cast<std::size_t>(i)];
    const Index j = after(i);
    const Index k = after(j);
    const Real gap_m = side.gap_m - s * side.gap;
    const Real sag_m = side.sag_m - s * side.sag;
    const Real beta = sides.offset_m(i);
    const Real over = sides.along(i) - at.step;
    const Real share = weight(i);
    if (k < 2) {
      given(k, i) = at.step;
      of_weight[static_cast<std::size_t>(k)].by_along(i) = share * at.step_slope;
    }
    if (j < 2) {
      given(j, i) = 1.0 - at.step;
      of_weight[static_cast<std::size_t>(j)].by_along(i) = -share * at.step_slope;
    }
    given(2, i) = over * beta * side.twist - at.bump * gap_m -
                  0.5 * b(i) * b(i) * sag_m + own_m(j) +
                  at.step * (own_m(k) - own_m(j));
    of_height.by_along(i) =
        share * (at.step_slope * (own_m(k) - own_m(j)) +
                 (1.0 - at.step_slope) * beta * side.twist - at.bump_slope * gap_m);
    of_height.by_offset(i) = share * over * side.twist;
  }
  const Vector3 mean = given * weight;
  Matrix3 by_share;  // (function x corner) derivative by b
  for (Index l = 0; l < 3; ++l) {
    const Index m = after(l);
    const Index o = after(m);
    // b_l is in q_m, with b_o, and in q_o, with b_m.
    by_share.col(l) = (2.0 * per_pairs * b(l)) * (b(o) * b(o) * (given.col(m) - mean) +
                                                  b(m) * b(m) * (given.col(o) - mean));
    by_share(2, l) -=
        weight(l) * b(l) * (side_of(triangle, l).sag_m - s * side_of(triangle, l).sag);
  }
  const Vector3 common = by_share * b;  // b sums to one
  for (Index i = 0; i < 3; ++i) {
    const Real rate = per_sum * side_of(triangle, i).per_altitude_m;
    of_weight[0].by_offset(i) = rate * (by_share(0, i) - common(0));
    of_weight[1].by_offset(i) = rate * (by_share(1, i) - common(1));
    of_height.by_offset(i) += rate * (by_share(2, i) - common(2));
  }
  point.weight = w;
  point.turn.row(0) = gradient_of(of_weight[0], sides);
  point.turn.row(1) = gradient_of(of_weight[1], sides);
  point.turn.row(2) = -point.turn.row(0) - point.turn.row(1);
  point.height_m = s;
  point.rise = per_under * (triangle.rise * w + gradient_of(of_height, sides));
  return true;
}

bool set_beyond(const SmoothTriangle& triangle, const SmoothSides& sides,
                const Vector3& x_m, SmoothPoint& point) noexcept {
  // The edge beyond which x lies and along which it has its foot; else, beyond a
  // corner, the one whose end is nearest.
  Index i = -1;
  Real nearest = 0.0;
  for (Index edge = 0; edge < 3; ++edge) {
    if (!sides.sound[static_cast<std::size_t>(edge)] ||
        !(sides.altitudes(edge) < 0.0)) {
      continue;
    }
    const Real t = sides.along(edge);
    const Real past = std::max({-t, t - Real(1.0), Real(0.0)}) *
                      side_of(triangle, edge).edge_m.norm();
    if (i < 0 || past < nearest) {
      i = edge;
      nearest = past;
    }
  }
  if (i < 0) {
    return false;
  }
  const Index j = after(i);
  const Index k = after(j);
  if (!(sides.along(i) > 0.0 && sides.along(i) < 1.0)) {
    set_on_line(triangle, sides.along(i) > 0.0 ? k : j, x_m, point);
    return true;
  }
  const SmoothSide& side = side_of(triangle, i);
  const Along at = along_edge(sides.along(i));
  const Real own_j = triangle.rise.col(j).dot(x_m - triangle.corner_m.col(j));
  const Real own_k = triangle.rise.col(k).dot(x_m - triangle.corner_m.col(k));
  const Real over = sides.along(i) - at.step;
  const Real beta = sides.offset_m(i);
  const Real under = 1.0 - at.bump * side.gap;
  if (!(under > kStretchMin)) {
    return false;
  }
  const Real per_under = 1.0 / under;
  const Real s = per_under * (own_j + at.step * (own_k - own_j) +
                              over * beta * side.twist - at.bump * side.gap_m);
  const Real by_along = at.step_slope * (own_k - own_j) +
                        (1.0 - at.step_slope) * beta * side.twist -
                        at.bump_slope * (side.gap_m - s * side.gap);
  point = {};
  point.weight(j) = 1.0 - at.step;
  point.weight(k) = at.step;
  point.turn.row(k) = at.step_slope * sides.along_gradient.col(i);
  point.turn.row(j) = -point.turn.row(k);
  point.height_m = s;
  point.rise = per_under *
               (triangle.rise * point.weight + by_along * sides.along_gradient.col(i) +
                (over * side.twist) * sides.offset_gradient.col(i));
  return true;
}

}  // namespace palpate
