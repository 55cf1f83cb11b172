// The nonlinear wall of the paper's experiments.
#pragma once

#include "runtime/paper/slow_value_curve.h"

namespace palpate {

/// Force, slope and energy of the wall of stiffness k [N/m] at penetration x [m]:
///
///   f = 0 for x <= 0,  100 k x^2 up to x = 5 mm,  k (x - 0.0025) beyond
///
/// The paper's (25) and (31) print the free space as "0 <= x" and the last line as
/// k (x - 0.000025), which jumps at 5 mm. Here value and slope are continuous
/// (200 k 0.005 = k). So k alone bounds the slope, as the paper's text says.
[[nodiscard]] SlowValue wall_response(double k_n_per_m, double x_m) noexcept;

/// Penetration at which the wall's force is f_n >= 0 [m].
[[nodiscard]] double wall_depth_m(double k_n_per_m, double f_n) noexcept;

}  // namespace palpate
