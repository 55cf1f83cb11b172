// Local models along one direction: what the fast process renders between two values
// of a slow simulation (paper, 5.1).
//
// x is the penetration along the direction [m], f the force against it [N]. The passive
// models differ in what an update makes of the slow value. The equal-energy update
// makes a linear impedance f = k (x - c) for x > c, else 0, with relaxed state c (19).
// The energy is E = k (x - c)^2 / 2 (21). The energy tank makes the curve of
// slow_value_curve.h.
#pragma once

#include "runtime/account/local_model.h"
#include "runtime/account/passivity_ledger.h"
#include "runtime/account/real.h"
#include "runtime/paper/slow_value_curve.h"

namespace palpate {

struct ScalarModel {
  LocalModel kind = LocalModel::kEnergyTank;  ///< one that does not follow a surface
  Real k_n_per_m = 0.0;                       ///< [N/m] >= 0, equal energy
  Real c_m = 0.0;                             ///< [m] relaxed state, equal energy
  LocalCurve curve;                           ///< energy tank
  SlowValue latest;                           ///< i
  SlowValue before;                           ///< i - 1
  int updates = 0;                            ///< slow values seen, counts up to 2
  Real since_s = 0.0;                         ///< [s] since the latest slow value
  Real interval_s = 0.0;                      ///< [s] between the two latest
};

/// Force [N] at x [m]. The holds do not look at x.
[[nodiscard]] Real force_n(const ScalarModel& model, Real x_m) noexcept;

/// Potential [J] at x [m]: (21), and f x for a held force.
[[nodiscard]] Real energy_j(const ScalarModel& model, Real x_m) noexcept;

/// The tool has moved to x_m and time has passed: books the work of the movement, then
/// the first-order hold extrapolates. Extrapolation ends after one interval, and a
/// wall does not pull, so that a stalled slow process leaves a bounded force.
/// @param dt_s [s] >= 0.
void advance(ScalarModel& model, PassivityLedger& ledger, Real x_m, Real dt_s) noexcept;

/// A slow value arrives, computed where the tool is; advance() has booked the work of
/// getting there, so ledger.stored_j is E_{i-1}(x_i).
///
/// Equal energy: k by (20), c by (22). k stays where x did not move, or (20) is not
/// positive: there the force changed for another reason than x. k is at most the larger
/// of the two tangents. Free space by (24). There is no tank.
///
/// Energy tank: the curve of the slow value. If that costs more than the allowance, the
/// curve is moved deeper until it holds what is allowed. Then the force is lower, and
/// the slope is that of the response less deep. The tank keeps at most the curve's own
/// energy at x_i and is emptied in free space.
void update(ScalarModel& model, PassivityLedger& ledger,
            const SlowValue& slow) noexcept;

}  // namespace palpate
