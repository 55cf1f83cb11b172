// The response along the normal at one place of an element, as its memory sees it.
//
// With the weights w_j, leans c_j and touch depths t_j of the three nodes,
//
//   p(y) = sum_j w_j c_j f_j(c_j (y - t_j)),   U(y) = sum_j w_j E_j(c_j (y - t_j)),
//
// y the depth without delta_0. Memory asks for a force that never falls with depth:
// where a curve falls, f_j is the cubic through the running maxima of its samples.
//
// Bundles: a convex curve is a superposition of springs that are touched one after the
// other. Cut at depths g_b, bundle b alone has
//
//   c_b(e) = f(m) - f(g_b) - f'(g_b) (m - g_b) + (f'(m) - f'(g_b)) (e - m),
//   m = min(e, g_{b+1}), zero for e <= g_b; from g_0 = 0 with f(0) = f'(0-) = 0,
//
// and they sum to f: a contact that is lifted loses its rim first (the method of
// dimensionality reduction; Popov & Hess).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include <Eigen/Core>

#include "runtime/account/real.h"
#include "runtime/element/cubic_cache.h"
#include "runtime/element/element.h"

namespace palpate {

/// A value per node; the fourth is always zero, so that two pairs make it.
using NodeValues = Eigen::Array<Real, 4, 1>;

/// Running maxima of a curve's samples: the piece around d > 0 [m] of the cubic through
/// them. Its slope is the sample's where the curve is at its maximum and goes on
/// rising, else 0. The same as piece_around() where the curve nowhere falls.
[[nodiscard]] CurvePiece rising_piece_around(const ElementCurve& curve,
                                             Real d) noexcept;

/// Where a bundle of a node's curve begins.
struct BundleCut {
  Real depth_m = 0.0;            ///< [m] g_b
  Real force_n = 0.0;            ///< [N] f(g_b)
  Real stiffness_n_per_m = 0.0;  ///< [N/m] f'(g_b); 0 for the first
  Real energy_j = 0.0;           ///< [J] E(g_b)
};

/// What of an element's nodes is the same at every depth and place.
struct PlaceNodes {
  std::int32_t bundles = 1;
  bool any_falls = false;
  std::array<bool, 3> falls{};    ///< some sample is below one before it
  std::array<Real, 3> lean{};     ///< [-] c_j >= 0; 0: no response
  std::array<Real, 3> touch_m{};  ///< [m] t_j
  std::array<std::array<BundleCut, kMemoryBundles>, 3> cut;
};

/// @param lean, touch_m (3) of the nodes as the local model takes them.
[[nodiscard]] PlaceNodes make_place_nodes(const Element& element,
                                          const std::array<Real, 3>& lean,
                                          const std::array<Real, 3>& touch_m) noexcept;

struct PlaceCurve {
  const Element& element;
  const PlaceNodes& nodes;
  const NodeValues& weight;  ///< [-] w_j >= 0
};

/// The pieces in which one bundle of the three nodes was evaluated last, as functions
/// of y. Each piece is a cubic of x = y - from_m for from_m < y <= to_m.
struct NodePieces {
  NodeValues from_m{0.0, 0.0, 0.0, -kFar};
  NodeValues to_m{0.0, 0.0, 0.0, kFar};
  NodeValues force_n = NodeValues::Zero();            ///< [N] c_j f_j at from_m
  NodeValues stiffness_n_per_m = NodeValues::Zero();  ///< [N/m]
  NodeValues bend_n_per_m2 = NodeValues::Zero();      ///< [N/m^2]
  NodeValues twist_n_per_m3 = NodeValues::Zero();     ///< [N/m^3]
  NodeValues energy_j = NodeValues::Zero();           ///< [J] E_j at from_m
  std::array<bool, 3> extrapolated{};                 ///< beyond the last sample

  /// [m] Farther than any depth; its fourth power is finite.
  static constexpr Real kFar = 1e6;
};

/// Of one bundle at one depth. Nodes count in node_j whether or not they have weight:
/// the field's slope along the surface needs them.
struct PlacePoint {
  Real force_n = 0.0;                      ///< [N] p
  Real stiffness_n_per_m = 0.0;            ///< [N/m] its derivative
  Real energy_j = 0.0;                     ///< [J] U
  NodeValues node_j = NodeValues::Zero();  ///< [J] E_j
  bool extrapolated = false;               ///< some node with weight is past its curve
};

/// @param pieces of this element and bundle; changed where y has left them.
[[nodiscard]] PlacePoint point_at(const PlaceCurve& curve, int bundle, Real y_m,
                                  NodePieces& pieces) noexcept;

/// Depth y of the first node that counts, where p begins [m].
[[nodiscard]] Real first_touch_m(const PlaceCurve& curve) noexcept;

/// One bundle around a depth. Where all three nodes stay in their intervals, p is one
/// cubic of x = y - origin, p = p_0 + x (p_1 + x (p_2 + x p_3)). U is its integral.
struct PlaceCubic {
  Real origin_m = 0.0;
  Real low_m = 0.0;  ///< [m] it holds for low < y <= high; empty: holds nowhere
  Real high_m = 0.0;
  Real force_n = 0.0;            ///< [N] p_0
  Real stiffness_n_per_m = 0.0;  ///< [N/m] p_1
  Real bend_n_per_m2 = 0.0;      ///< [N/m^2] p_2
  Real twist_n_per_m3 = 0.0;     ///< [N/m^3] p_3
  Real energy_j = 0.0;           ///< [J] U at the origin

  [[nodiscard]] bool holds(Real y_m) const noexcept {
    return y_m > low_m && y_m <= high_m;
  }
  [[nodiscard]] Real force_at(Real y_m) const noexcept {
    const Real x = y_m - origin_m;
    return force_n + x * (stiffness_n_per_m + x * (bend_n_per_m2 + x * twist_n_per_m3));
  }
  [[nodiscard]] Real stiffness_at(Real y_m) const noexcept {
    const Real x = y_m - origin_m;
    return stiffness_n_per_m + x * (2.0 * bend_n_per_m2 + x * (3.0 * twist_n_per_m3));
  }
  [[nodiscard]] Real energy_at(Real y_m) const noexcept {
    const Real x = y_m - origin_m;
    return energy_j + x * (force_n + x * (0.5 * stiffness_n_per_m +
                                          x * (bend_n_per_m2 * (1.0 / 3.0) +
                                               x * (0.25 * twist_n_per_m3))));
  }
};

/// What Newton's method may begin its last step with of the force, relative. It takes
/// the cubic's curvature off a step, so that one leaves no more than its third power.
constexpr Real kLastStepForce = 3e-3;

/// The depth of a force within a cubic, by Newton's method from y. @returns whether it
/// stays in the cubic; y is that depth then.
[[nodiscard]] inline bool find_within(const PlaceCubic& cubic, Real force_n,
                                      Real& y_m) noexcept {
  constexpr int kStepMax = 8;
  Real y = y_m;
  for (int i = 0; i < kStepMax && cubic.holds(y); ++i) {
    const Real x = y - cubic.origin_m;
    const Real missing = force_n - cubic.force_at(y);
    const Real compliance = Real(1.0) / cubic.stiffness_at(y);
    const Real bend = cubic.bend_n_per_m2 + 3.0 * cubic.twist_n_per_m3 * x;
    const Real dx = missing * compliance;
    const Real bent = dx * dx * (bend + cubic.twist_n_per_m3 * dx) * compliance;
    y += std::abs(bent) < std::abs(dx) ? dx - bent : dx;
    if (std::abs(missing) <= kLastStepForce * force_n && cubic.holds(y)) {
      y_m = y;
      return true;
    }
  }
  return false;
}

[[nodiscard]] PlaceCubic cubic_around(const PlaceCurve& curve, int bundle, Real y_m,
                                      NodePieces& pieces) noexcept;

/// The depth at which a bundle's curve has a force, p(depth) = q, and the energy there.
struct CurveInverse {
  Real depth_m = 0.0;   ///< [m] delta(q)
  Real energy_j = 0.0;  ///< [J] U(delta)
};

/// Looks for the depth of a force in other cubics than the one at hand, between the
/// first touch and most_m. Where the curve has no such force there, the nearest depth.
/// @param force_n [N] q >= 0; 0 gives the first touch.
/// @param most_m  [m] where the curve is above the force, or as far as it is looked
/// for.
/// @param cubic   left where the force was found.
[[nodiscard]] CurveInverse search_inverse(const PlaceCurve& curve, int bundle,
                                          Real force_n, Real near_m, Real most_m,
                                          PlaceCubic& cubic,
                                          NodePieces& pieces) noexcept;

/// The same, first in the cubic at hand. @param cubic of this place and bundle, or
/// empty.
[[nodiscard]] inline CurveInverse inverse(const PlaceCurve& curve, int bundle,
                                          Real force_n, Real near_m, Real most_m,
                                          PlaceCubic& cubic,
                                          NodePieces& pieces) noexcept {
  Real y = near_m;
  if (force_n > 0.0 && find_within(cubic, force_n, y)) {
    return {y, cubic.energy_at(y)};
  }
  return search_inverse(curve, bundle, force_n, near_m, most_m, cubic, pieces);
}

}  // namespace palpate
