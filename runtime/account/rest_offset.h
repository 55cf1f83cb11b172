// Smallest rest-position offset delta_0 for which the energy of a local model stays
// within an allowance (paper, (19) to (24)). Templates, because the local models
// evaluate their energy in their own way.
#pragma once

#include <algorithm>

#include "runtime/account/real.h"

namespace palpate {

/// Part of an allowance that is spent where rounding must not exceed it.
constexpr Real kPaid = rounding(1.0, 1.0 - 1e-6);

/// Energy of a local model at one delta_0, and its derivative's negative.
struct ShiftedEnergy {
  Real shift_m = 0.0;   ///< [m] delta_0
  Real energy_j = 0.0;  ///< [J]
  Real force_n = 0.0;   ///< [N] -dE/d(delta_0)
};

/// Smallest delta_0 for which the energy is at most allowed_j. Newton's method from
/// below, kept in its bracket, at most 40 evaluations. The result is on the allowed
/// side, within 1e-9 (float: 1e-5) of the allowance.
/// @param now more than allowed_j is held at this delta_0.
/// @param shift_max_m [m] delta_0 at which nothing is held.
/// @param at_shift delta_0 -> ShiftedEnergy.
template <typename AtShift>
[[nodiscard]] Real raised_shift_m(ShiftedEnergy now, Real shift_max_m, Real allowed_j,
                                  const AtShift& at_shift) noexcept {
  constexpr int kSolveMax = 40;
  constexpr Real kRelative = rounding(1e-9, 1e-5);
  constexpr Real kSmallestJ = rounding(1e-16, 1e-12);
  const Real target_j = std::max(0.0, allowed_j * (1.0 - 0.5 * kRelative));
  Real low = now.shift_m;
  Real high = shift_max_m;
  for (int i = 0; i < kSolveMax && allowed_j > kSmallestJ; ++i) {
    if (now.energy_j > allowed_j) {
      low = now.shift_m;
    } else if (now.energy_j < allowed_j * (1.0 - kRelative)) {
      high = now.shift_m;
    } else {
      return now.shift_m;
    }
    const Real newton = now.shift_m + (now.energy_j - target_j) / now.force_n;
    const bool in_bracket = newton > low && newton < high;
    now = at_shift(in_bracket ? newton : 0.5 * (low + high));
  }
  return now.energy_j <= allowed_j ? now.shift_m : high;
}

/// delta_0 reduced as far as time and the unspent allowance permit.
/// @param now     the present state, of which unspent_j is left.
/// @param step_m  [m] most that time permits.
template <typename AtShift>
[[nodiscard]] Real recovered_shift_m(const ShiftedEnergy& now, Real step_m,
                                     Real unspent_j, const AtShift& at_shift) noexcept {
  Real back = std::min(now.shift_m, step_m);
  for (int attempt = 0; attempt < 2 && back > 0.0; ++attempt) {
    const Real cost = at_shift(now.shift_m - back).energy_j - now.energy_j;
    if (cost <= unspent_j) {
      return now.shift_m - back;
    }
    back *= std::max(0.0, unspent_j / cost);
  }
  return now.shift_m;
}

}  // namespace palpate
