// A response between two slow values, from the latest one alone.
//
// A slow value says four things of the curve: force f, slope k and energy E at x, and
// where it was touched. One cubic through the touch has them all. With l = x - touch
// and s = (x' - touch) / l,
//
//   f(x') = f s (a1 + a2 s + a3 s^2),   a3 = 12 E/(f l) - 8 + 2 k l/f,
//   a2 = k l/f - 1 - 2 a3,              a1 = 2 - k l/f + a3
//
// It is the response itself where that is linear, quadratic or cubic. Deeper than x it
// goes on by slope and curvature, no steeper than three times k and never falling.
#pragma once

#include "runtime/account/real.h"

namespace palpate {

/// One value of a slow simulation.
struct SlowValue {
  Real x_m = 0.0;        ///< [m] penetration at which it was computed
  Real f_n = 0.0;        ///< [N] f(x)
  Real k_n_per_m = 0.0;  ///< [N/m] f'(x)
  Real energy_j = 0.0;   ///< [J] integral of f from 0 to x
  Real touch_m = 0.0;    ///< [m] penetration below which f is 0
};

/// The cubic and its continuation; lowered where energy is short (lower()).
struct LocalCurve {
  Real end_m = 0.0;            ///< [m] x
  Real length_m = 0.0;         ///< [m] l; 0: no response
  Real force_n = 0.0;          ///< [N] f
  Real a1 = 1.0;               ///< [-]
  Real a2 = 0.0;               ///< [-]
  Real a3 = 0.0;               ///< [-]
  Real k_n_per_m = 0.0;        ///< [N/m] slope at x, for the continuation >= 0
  Real bend_n_per_m2 = 0.0;    ///< [N/m^2] curvature at x
  Real shift_m = 0.0;          ///< [m] delta_0 >= 0, the cubic is moved deeper by it
  Real blend = 0.0;            ///< [-] [0, 1], of the tangent's force above x
  Real tangent_n = 0.0;        ///< [N] force of the tangent at x
  Real tangent_n_per_m = 0.0;  ///< [N/m] and its slope
};

struct CurvePoint {
  Real force_n = 0.0;            ///< [N] >= 0
  Real stiffness_n_per_m = 0.0;  ///< [N/m] its slope
  Real energy_j = 0.0;           ///< [J] >= 0, its integral
};

/// The curve of a slow value in contact. Where the cubic would pull or be steeper than
/// three times what k and f/l say, the curve is a line. The line has f and the
/// tangent's slope, or f^2/(2 E) where that is larger (a plateau's tangent would store
/// more than the curve).
[[nodiscard]] LocalCurve local_curve(const SlowValue& slow) noexcept;

[[nodiscard]] CurvePoint at(const LocalCurve& curve, Real x_m) noexcept;

/// Makes a fresh curve hold at most allowed_j [J] at x. First its shallower part gives
/// way to the tangent at x, which stores less where the response is convex: force and
/// slope at x stay. Where the tangent alone stores too much, the curve is moved deeper,
/// so that slope and force stay those of one point of the response.
void lower(LocalCurve& curve, Real allowed_j) noexcept;

}  // namespace palpate
