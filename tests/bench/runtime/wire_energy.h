// What a wire with a delay may create of energy, and whether a run kept to it.
//
// The renderer's account is of a potential. E(x_{k+1}) - E(x_k) is what the tool puts
// in from one position to the next, and its sum is never below zero. The device holds
// F_k meanwhile, so that the work on the tool is not that: each tick adds up to K
// |x_{k+1} - x_k|^2 / 2. And it holds F_k from the place s_k to s_{k+1}, which are not
// the positions that were seen. Let d_k = s_k - x_k, and no force change faster than K
// per length. Summation by parts then gives for the work of the motors on the tool
//
//   W <= F_N . d_N + K sum (|d_k| + |x_k - x_{k-1}| / 2) |x_k - x_{k-1}|
//     <= |F_N| (L(t) - L(t - A)) + K (A Q + 2 D L)
//
// The sum's term K |x_k - x_{k-1}|^2 / 2 is the one that sampling alone adds. A: age of
// a force when the next takes its place [s]. A is at least delay plus half the time
// that the force is held. Q: integral of the squared speed over time [m^2/s]; L: length
// of the way [m]; D: resolution [m]. Q and L are over the time with force, and A before
// it. A mechanism whose damping B >= K A absorbs the term in A: the bound of Diolaiti
// et al. 2006.
#pragma once

#include <span>

#include "runtime/emulation/emulated_falcon_board.h"

namespace palpate {

struct WireEnergy {
  double given_max_j = 0.0;   ///< [J] most that the motors had given, net, at a time
  double given_end_j = 0.0;   ///< [J] net at the end; negative: taken
  double bound_end_j = 0.0;   ///< [J] what the bound allows by then
  double margin_min_j = 0.0;  ///< [J] least of bound - given; negative: broken
  double squared_speed_m2_per_s = 0.0;  ///< Q, of the whole run
  double path_m = 0.0;                  ///< L, of the whole run
};

/// @param k_n_per_m  [N/m] largest stiffness rendered. @param age_s [s] A, the largest.
/// @param resolution_m [m] D.
[[nodiscard]] WireEnergy wire_energy(std::span<const MotorRecord> trace,
                                     double k_n_per_m, double age_s,
                                     double resolution_m);

}  // namespace palpate
