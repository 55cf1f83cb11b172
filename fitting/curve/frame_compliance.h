// Compliance of a machine: how far it deflects under the force that it exerts.
//
//   d = x - u(F - F0)
//
// Symbols: x displacement that the machine reports [m], F force [N], F0 force before
// contact. u is the deflection of frame, load cell and tip holder [m], d what the tip
// moved.
#pragma once

#include <limits>
#include <vector>

#include "formats/database/response_database.h"

namespace palpate {

struct FrameCompliance {
  /// (k) [N], [m] the deflection's curve, both rising from (0, 0), k >= 2; straight
  /// between its points. A frame of constant stiffness has the points 0 and 1 N.
  std::vector<double> force_n, deflection_m;
  bool linear = true;  ///< holds for all forces; else up to the largest force alone
  double stiffness_n_per_m = 0.0;  ///< [N/m] largest force over its deflection
  double stiffness_sd_n_per_m = std::numeric_limits<double>::quiet_NaN();
  ///< [N/m] standard deviation; NaN: not known
};

/// @param stiffness_n_per_m > 0. @param sd_n_per_m >= 0, NaN: not known.
/// @throws InputError otherwise.
[[nodiscard]] FrameCompliance linear_frame(
    double stiffness_n_per_m,
    double sd_n_per_m = std::numeric_limits<double>::quiet_NaN());

/// Deflection [m] under a force [N]; odd in the force, the last piece goes on.
[[nodiscard]] double deflection_m(const FrameCompliance& frame, double force_n);

/// The frame with all deflections times 1 + s/k, k and s the stiffness and its standard
/// deviation: softer by one standard deviation, to first order.
[[nodiscard]] FrameCompliance softer(const FrameCompliance& frame);

/// What a frame took of one press.
struct FrameEffect {
  double deflection_m = 0.0;  ///< [m] at the largest force; 0 without a frame
  double share = 0.0;  ///< [-] of the travel in contact, deflection over it and depth
  double depth_sd_m = 0.0;
  ///< [m] what the stiffness' standard deviation makes of the largest depth
};

constexpr double kFrameForceBeyond =
    1.1;                                ///< [-] largest force of a run over the frame's
constexpr double kFrameShareMax = 0.5;  ///< [-] more is flagged

/// Takes the deflection off the displacements. Both signs as of an approach:
/// compression and its force positive.
/// @param first_n samples of the approach. F0 is the median force of its first five.
/// @throws InputError where the frame takes all that the machine moved while the
/// approach's force rose from half to its largest. InputError too where the force
/// exceeds that of a frame whose stiffness is not constant by more than
/// kFrameForceBeyond.
void take_off_deflection(const FrameCompliance& frame, std::size_t first_n,
                         Measurement& measurement);

}  // namespace palpate
