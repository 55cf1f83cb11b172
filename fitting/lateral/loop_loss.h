// The energy that a closed loop of lateral motion loses.
//
//   W = int q du over the loop,   measured = modelled - sum_i r_i du_i
//
// Symbols: q tangential force [N], u displacement [m], r_i modelled less measured force
// [N]. The modelled force is integrated between samples and through the turns; of the
// measured force the residuals alone are summed. Offset and drift are taken off.
#pragma once

#include <vector>

#include "fitting/lateral/loop_solve.h"

namespace palpate {

/// From one end or turn of the path over the next to the one after.
struct LoopCycle {
  double amplitude_m = 0.0;  ///< half the way from turn to turn
  double measured_j = 0.0;
  double modelled_j = 0.0;
  double sd_j = 0.0;  ///< of the measured loss, by noise
};

struct LoopLosses {
  std::vector<LoopCycle> cycle;  ///< closed ones, in order; may be empty
  double mean_sd_j = 0.0;        ///< of the mean over the cycles
  /// Squares of deviations from the mean of measured less modelled losses, over their
  /// variances by noise that is short beside a cycle.
  double chi_squared = 0.0;
};

constexpr double kClosedShare = 0.05;  ///< [-] of place and force, by which ends differ

/// A cycle is closed where its ends have the same place and the same force.
[[nodiscard]] LoopLosses loop_losses(const LateralPath& path, const SolvedLoop& solved);

}  // namespace palpate
