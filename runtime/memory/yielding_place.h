// A place of the surface that yields: dents that stay, curves that soften.
//
// State, at sites (sites_at_hand.h), blended at the place: D >= 0 the dent, m >= 0 the
// depth up to which the curve has softened [m]. p and U are those of place_curve.h, Y
// is the depth past which dents stay, and r the share of what is past Y. The elastic
// response at the depth e = y - D is p stretched past Y,
//
//   p_e(e) = p(l),  U_e(e) = U(l)                      for e <= Y, l = e;
//                   U_e(e) = r U(Y) + (1 - r) U(l)     past it, l = Y + (e - Y)/(1 - r)
//
// so that dU_e/de = p_e. A first press leaves D = r (y - Y): l = y, and its force is
// p(y), to rounding, at every place. What is lifted and pressed again follows p_e from
// the dent, and past the deepest press p once more.
//
// Softening: node j's curve counts for 1 - omega_j(m),
//
//   omega_j(m) = omega_max (1 - exp(-max(c_j (m - t_j) - m_0, 0) / m_1)),
//
// of the response without damage (element.h), so that a first press, m = y, gives the
// stored one.
//
// Y = sum w_j (t_j + d_y,j / c_j) and r = sum w_j r_j are linear in the place, as D and
// m are. So the potential U_e(y - D) is continuous over the surface.
#pragma once

#include <algorithm>
#include <array>

#include <Eigen/Core>

#include "runtime/account/real.h"
#include "runtime/element/element.h"
#include "runtime/element/turned.h"
#include "runtime/memory/place_curve.h"

namespace palpate {

/// What of an element's nodes is the same at every place.
struct YieldingNodes {
  bool any = false;                  ///< the tool yields
  bool softens = false;              ///< some of these nodes does
  std::array<Real, 3> yield_m{};     ///< [m] Y of each, as y
  std::array<Real, 3> share{};       ///< [-] r
  std::array<Real, 3> onset_m{};     ///< [m] m_0 of each, as y
  std::array<Real, 3> rate_per_m{};  ///< [1/m] c_j / m_1
  std::array<Real, 3> most{};        ///< [-] omega_max
  Real first_onset_m = 0.0;          ///< [m] the least of those that soften
};

/// @param nodes of the same element.
[[nodiscard]] YieldingNodes make_yielding_nodes(const ElementMemory& memory,
                                                const PlaceNodes& nodes) noexcept;

/// The state where the contact is. By default nothing yields: l = y.
struct YieldingPlace {
  Turned<Real> dent_m{0.0, 0.0, 0.0, 0.0};      ///< [m] D
  Turned<Real> softened_m{0.0, 0.0, 0.0, 0.0};  ///< [m] m
  Turned<Real> yield_m{0.0, 0.0, 0.0, 0.0};     ///< [m] Y
  Turned<Real> share{0.0, 0.0, 0.0, 0.0};       ///< [-] r
  Real stretch = 1.0;                           ///< [-] 1 / (1 - r)

  /// l of a depth y [m].
  [[nodiscard]] Real curve_depth_m(Real y_m) const noexcept {
    const Real e = y_m - dent_m.value;
    return e > yield_m.value ? yield_m.value + (e - yield_m.value) * stretch : e;
  }
  /// e of a depth l [m].
  [[nodiscard]] Real elastic_depth_m(Real l_m) const noexcept {
    const Real past = l_m - yield_m.value;
    return past > 0.0 ? yield_m.value + (Real(1.0) - share.value) * past : l_m;
  }
  /// r where l [m] is past Y, else 0: U_e = share U(Y) + (1 - share) U(l).
  [[nodiscard]] Real share_at(Real l_m) const noexcept {
    return l_m > yield_m.value ? share.value : Real(0.0);
  }
  /// D that a first press to y [m] leaves.
  [[nodiscard]] Real asked_dent_m(Real y_m) const noexcept {
    return share.value * std::max(Real(0.0), y_m - yield_m.value);
  }
};

/// Y and r at a place. @param weight w_j >= 0.
void locate(YieldingPlace& place, const YieldingNodes& nodes, const NodeValues& weight,
            const Turn& turn) noexcept;

/// Takes what has softened off the weights of the curves, and off their derivatives.
void soften(const YieldingPlace& place, const YieldingNodes& nodes, NodeValues& weight,
            Turn& turn) noexcept;

/// Derivatives of U_e by the place's coordinates at the depth e of l [J].
/// @param at, at_yield the curve at l and at Y.
[[nodiscard]] Vector3 stored_slope_j(const YieldingPlace& place, const PlacePoint& at,
                                     const PlacePoint& at_yield, Real l_m,
                                     const Turn& turn) noexcept;

}  // namespace palpate
