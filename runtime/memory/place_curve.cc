#include "runtime/memory/place_curve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace palpate {
namespace {

constexpr int kSolveMax = 60;

// Samples of the rising curve one after another.
class RisingSamples {
 public:
  explicit RisingSamples(const ElementCurve& curve) : curve_(curve) {}

  // To sample i + 1, with the energy of the cubic between.
  void advance() {
    const CurvePiece piece = between();
    energy_ = piece.at(piece.to_m).energy_j;
    force_ = std::max(force_, curve_.force_n[index_ + 1]);
    ++index_;
  }

  [[nodiscard]] std::size_t index() const { return index_; }

  [[nodiscard]] CurvePiece between() const {
    const std::size_t i = index_;
    const Real next = std::max(force_, curve_.force_n[i + 1]);
    const Real h = curve_.depth_m[i + 1] - curve_.depth_m[i];
    const Real s = (next - force_) / h;
    const Real m0 = slope(i, force_, s);
    const Real m1 = slope(i + 1, next, s);
    return {.from_m = curve_.depth_m[i],
            .to_m = curve_.depth_m[i + 1],
            .force_n = force_,
            .stiffness_n_per_m = m0,
            .bend_n_per_m2 = (3.0 * s - 2.0 * m0 - m1) / h,
            .twist_n_per_m3 = (m0 + m1 - 2.0 * s) / (h * h),
            .energy_j = energy_};
  }

  [[nodiscard]] CurvePiece beyond() const {
    const std::size_t last = curve_.depth_m.size() - 1;
    const bool top = !(curve_.force_n[last] < force_);
    return {.from_m = curve_.depth_m[last],
            .to_m = std::numeric_limits<Real>::infinity(),
            .force_n = force_,
            .stiffness_n_per_m =
                top ? std::max(Real(0.0), curve_.stiffness_n_per_m[last]) : Real(0.0),
            .energy_j = energy_,
            .extrapolated = true};
  }

 private:
  // Of the rising curve at a sample: its own where it is at its maximum; limited to
  // three secants, so that the cubic does not fall.
  [[nodiscard]] Real slope(std::size_t i, Real top, Real secant) const {
    const bool own = !(curve_.force_n[i] < top);
    return own ? std::clamp(curve_.stiffness_n_per_m[i], Real(0.0), Real(3.0) * secant)
               : Real(0.0);
  }

  const ElementCurve& curve_;
  std::size_t index_ = 0;
  Real force_ = 0.0;
  Real energy_ = 0.0;
};

CurvePiece whole_piece(const PlaceCurve& curve, std::size_t j, Real e) {
  const ElementCurve samples = curve.element.node[j].curve();
  return curve.nodes.falls[j] ? rising_piece_around(samples, e)
                              : piece_around(samples, e);
}

// The same piece from a depth within it on.
CurvePiece begun_at(const CurvePiece& piece, Real from_m) {
  const Real x = from_m - piece.from_m;
  const ElementSample at = piece.at(from_m);
  CurvePiece begun = piece;
  begun.from_m = from_m;
  begun.force_n = at.force_n;
  begun.stiffness_n_per_m = at.stiffness_n_per_m;
  begun.bend_n_per_m2 = piece.bend_n_per_m2 + 3.0 * piece.twist_n_per_m3 * x;
  begun.energy_j = at.energy_j;
  return begun;
}

// Takes the part before a cut off a piece: what the bundles before have.
void take_off(CurvePiece& piece, const BundleCut& from) {
  const Real x = piece.from_m - from.depth_m;
  const Real m = from.stiffness_n_per_m;
  piece.energy_j -= from.energy_j + (from.force_n + 0.5 * m * x) * x;
  piece.force_n -= from.force_n + m * x;
  piece.stiffness_n_per_m -= m;
}

CurvePiece bundle_piece(const PlaceCurve& curve, std::size_t j, int bundle, Real e) {
  if (curve.nodes.bundles == 1) {
    return whole_piece(curve, j, e);
  }
  const auto b = static_cast<std::size_t>(bundle);
  const auto& cut = curve.nodes.cut[j];
  const BundleCut& from = cut[b];
  // The bundle's springs are not touched yet.
  if (!(e > from.depth_m)) {
    return {.from_m = 0.0, .to_m = from.depth_m};
  }
  CurvePiece piece;
  if (bundle + 1 == curve.nodes.bundles || e <= cut[b + 1].depth_m) {
    // Between its cuts: f(e) - f(g_b) - f'(g_b) (e - g_b).
    piece = whole_piece(curve, j, e);
    if (piece.from_m < from.depth_m) {
      piece = begun_at(piece, from.depth_m);
    }
    if (bundle + 1 < curve.nodes.bundles) {
      piece.to_m = std::min(piece.to_m, cut[b + 1].depth_m);
    }
    take_off(piece, from);
    return piece;
  }
  // Past them all springs are in contact: straight on with the slope f'(g_{b+1}) -
  // f'(g_b).
  const BundleCut& to = cut[b + 1];
  piece = {.from_m = to.depth_m,
           .to_m = std::numeric_limits<Real>::infinity(),
           .force_n = to.force_n,
           .stiffness_n_per_m = to.stiffness_n_per_m,
           .energy_j = to.energy_j};
  take_off(piece, from);
  return piece;
}

// The piece of one node around y, as a function of y.
void renew(const PlaceCurve& curve, int bundle, std::size_t j, Real y,
           NodePieces& pieces) {
  const auto row = static_cast<Eigen::Index>(j);
  const Real c = curve.nodes.lean[j];
  const Real t = curve.nodes.touch_m[j];
  CurvePiece piece;
  Real from = -NodePieces::kFar;
  Real to = c > 0.0 ? t : NodePieces::kFar;
  if (c > 0.0 && y > t) {
    piece = bundle_piece(curve, j, bundle, c * (y - t));
    from = t + piece.from_m / c;
    to = t + piece.to_m / c;
  }
  pieces.from_m(row) = from;
  pieces.to_m(row) = to;
  pieces.force_n(row) = c * piece.force_n;
  pieces.stiffness_n_per_m(row) = c * c * piece.stiffness_n_per_m;
  pieces.bend_n_per_m2(row) = c * c * c * piece.bend_n_per_m2;
  pieces.twist_n_per_m3(row) = c * c * c * c * piece.twist_n_per_m3;
  pieces.energy_j(row) = piece.energy_j;
  pieces.extrapolated[j] = piece.extrapolated;
}

void turn_to(const PlaceCurve& curve, int bundle, Real y, NodePieces& pieces) {
  for (std::size_t j = 0; j < 3; ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    if (!(y > pieces.from_m(row) && y <= pieces.to_m(row))) [[unlikely]] {
      renew(curve, bundle, j, y, pieces);
    }
  }
}

// f of each node's piece, x after its start [m].
NodeValues force_at(const NodePieces& p, const NodeValues& x) {
  return p.force_n +
         x * (p.stiffness_n_per_m + x * (p.bend_n_per_m2 + x * p.twist_n_per_m3));
}

// f' of each.
NodeValues stiffness_at(const NodePieces& p, const NodeValues& x) {
  return p.stiffness_n_per_m +
         x * (2.0 * p.bend_n_per_m2 + x * (3.0 * p.twist_n_per_m3));
}

}  // namespace

CurvePiece rising_piece_around(const ElementCurve& curve, Real d) noexcept {
  RisingSamples samples(curve);
  const std::size_t last = curve.depth_m.size() - 1;
  const std::size_t wanted = d > curve.depth_m[last] ? last : curve.interval(d);
  while (samples.index() < wanted) {
    samples.advance();
  }
  return wanted == last ? samples.beyond() : samples.between();
}

PlaceNodes make_place_nodes(const Element& element, const std::array<Real, 3>& lean,
                            const std::array<Real, 3>& touch_m) noexcept {
  PlaceNodes nodes;
  nodes.bundles = element.memory.bundles;
  nodes.touch_m = touch_m;
  for (std::size_t j = 0; j < 3; ++j) {
    const ElementNode& node = element.node[j];
    const ElementCurve curve = node.curve();
    nodes.lean[j] = node.samples > 0 ? lean[j] : Real(0.0);
    nodes.falls[j] = !std::is_sorted(curve.force_n.begin(), curve.force_n.end());
    nodes.any_falls = nodes.any_falls || nodes.falls[j];
    // f, f' and E at cut g_b. Bundle 0 begins at 0 with slope 0, a cut of 0 likewise.
    for (int b = 1; b < nodes.bundles && node.samples > 0; ++b) {
      const auto at = static_cast<std::size_t>(b);
      const Real g = element.memory.node[j].cut_m[at - 1];
      if (g > 0.0) {
        const ElementSample sample =
            (nodes.falls[j] ? rising_piece_around(curve, g) : piece_around(curve, g))
                .at(g);
        nodes.cut[j][at] = {g, sample.force_n, sample.stiffness_n_per_m,
                            sample.energy_j};
      }
    }
  }
  return nodes;
}

PlacePoint point_at(const PlaceCurve& curve, int bundle, Real y_m,
                    NodePieces& pieces) noexcept {
  turn_to(curve, bundle, y_m, pieces);
  const NodePieces& p = pieces;
  const NodeValues x = y_m - p.from_m;
  const NodeValues force = force_at(p, x);
  const NodeValues stiffness = stiffness_at(p, x);
  PlacePoint point;
  point.node_j =
      p.energy_j + x * (p.force_n + x * (0.5 * p.stiffness_n_per_m +
                                         x * ((1.0 / 3.0) * p.bend_n_per_m2 +
                                              x * (0.25 * p.twist_n_per_m3))));
  point.force_n = (curve.weight * force).sum();
  point.stiffness_n_per_m = (curve.weight * stiffness).sum();
  point.energy_j = (curve.weight * point.node_j).sum();
  if (p.extrapolated[0] || p.extrapolated[1] || p.extrapolated[2]) [[unlikely]] {
    for (std::size_t j = 0; j < 3; ++j) {
      point.extrapolated =
          point.extrapolated ||
          (p.extrapolated[j] && curve.weight(static_cast<Eigen::Index>(j)) > 0.0);
    }
  }
  return point;
}

Real first_touch_m(const PlaceCurve& curve) noexcept {
  Real first = std::numeric_limits<Real>::infinity();
  for (std::size_t j = 0; j < 3; ++j) {
    if (curve.nodes.lean[j] > 0.0 && curve.weight(static_cast<Eigen::Index>(j)) > 0.0) {
      first = std::min(first, curve.nodes.touch_m[j]);
    }
  }
  return first;
}

PlaceCubic cubic_around(const PlaceCurve& curve, int bundle, Real y_m,
                        NodePieces& pieces) noexcept {
  turn_to(curve, bundle, y_m, pieces);
  const NodePieces& p = pieces;
  const NodeValues x = y_m - p.from_m;
  const NodeValues& w = curve.weight;
  const NodeValues force = force_at(p, x);
  const NodeValues stiffness = stiffness_at(p, x);
  const NodeValues energy =
      p.energy_j + x * (p.force_n + x * (0.5 * p.stiffness_n_per_m +
                                         x * ((1.0 / 3.0) * p.bend_n_per_m2 +
                                              x * (0.25 * p.twist_n_per_m3))));
  return {.origin_m = y_m,
          .low_m = p.from_m.maxCoeff(),
          .high_m = p.to_m.minCoeff(),
          .force_n = (w * force).sum(),
          .stiffness_n_per_m = (w * stiffness).sum(),
          .bend_n_per_m2 = (w * (p.bend_n_per_m2 + x * (3.0 * p.twist_n_per_m3))).sum(),
          .twist_n_per_m3 = (w * p.twist_n_per_m3).sum(),
          .energy_j = (w * energy).sum()};
}

CurveInverse search_inverse(const PlaceCurve& curve, int bundle, Real force_n,
                            Real near_m, Real most_m, PlaceCubic& cubic,
                            NodePieces& pieces) noexcept {
  Real low = first_touch_m(curve);
  if (!(force_n > 0.0) || !(most_m > low)) {
    return {.depth_m = low};
  }
  // p(low) <= q <= p(high), for p does not fall.
  Real high = most_m;
  Real y = near_m > low && near_m < high ? near_m : 0.5 * (low + high);
  for (int i = 0; i < kSolveMax; ++i) {
    cubic = cubic_around(curve, bundle, y, pieces);
    Real found = y;
    if (find_within(cubic, force_n, found)) {
      return {found, cubic.energy_at(found)};
    }
    // Newton's method where it stays in the bracket, else its middle.
    const Real missing = force_n - cubic.force_n;
    (missing > 0.0 ? low : high) = y;
    const Real newton = y + missing / cubic.stiffness_n_per_m;
    const Real next = newton > low && newton < high ? newton : 0.5 * (low + high);
    if (!(next > low && next < high)) {
      break;
    }
    y = next;
  }
  return {y, cubic.energy_at(y)};
}

}  // namespace palpate
