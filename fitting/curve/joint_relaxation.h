// Relaxation and instantaneous curve of one press with its holds, found together, so
// that they do not depend on how fast the press was.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fitting/curve/quasi_linear.h"

namespace palpate {

/// Samples of one press from its start on, compression and force positive. Earlier
/// holds may interrupt the press, and later ones the release.
struct PressAndHold {
  std::span<const double> time_s, displacement_m, force_n;  ///< (n) each
  std::size_t hold_begin = 0;  ///< the press is before it, ...
  std::size_t hold_end = 0;    ///< ... the release, while there is contact, from it on
};

struct JointRelaxation {
  std::string refused = "not fitted";  ///< why there is none; empty where there is
  std::vector<RelaxationTerm> terms;   ///< 1 to 3, tau rising
  /// (2K x 2K) of g_1 .. g_K [-] and ln tau_1 .. ln tau_K; empty: not known
  Eigen::MatrixXd covariance;
  double g_inf = 1.0;  ///< [-] 1 - sum g, terms not claimed among them
  double g_inf_sd = 0.0;
  std::string curve;  ///< "power-law" or "monotone-spline"
  /// The instantaneous curve without baseline, from the contact point to the deepest.
  std::vector<double> displacement_m, force_n, force_sd_n;
  /// [s] A tenth of the force that relaxes faster would not show in this hold: g_inf
  /// and the instantaneous curve take it as already gone.
  double seen_from_s = 0.0;
  double baseline_n = 0.0;            ///< [N]
  double rms_relative = 0.0;          ///< [-] of the residuals, over the largest force
  std::size_t samples = 0;            ///< fitted, or means of neighbours
  std::size_t holds = 0;              ///< of the press and its release
  std::size_t holds_used = 0;         ///< of them, in contact and fitted
  bool release = false;               ///< whether the release is among them
  double release_rms_relative = 0.0;  ///< [-] that it is off where it is not; else 0
  bool converged = false;
};

/// A hold of fewer samples tells nothing.
inline constexpr std::size_t kHoldSamplesMin = 12;

/// Least squares over all ramps and holds (press_model.h), neighbours averaged where
/// the force changes slowly (press_rows.h). The curve is a power law or a monotone
/// spline, the terms one to three. The choice has the smallest n ln(squares) + p ln(n),
/// n the number of independent samples, p that of the parameters. Standard deviations
/// from the residuals' own noise, white and shared by neighbours. A release is added
/// where the same model follows it: the residuals' rms grows by no more than a quarter.
/// Refused for fewer than 8 samples before the hold and 12 in the longest.
[[nodiscard]] JointRelaxation fit_press_and_hold(const PressAndHold& measured);

/// Share of the force at the end of a press at a speed [m/s]. The share is what is left
/// after the tool has stayed for a time [s]. @param joint not refused.
[[nodiscard]] double held_share(const JointRelaxation& joint, double speed_m_per_s,
                                double time_s);

struct RelaxedShare {
  double value = 0.0;  ///< [-]
  double sd = 0.0;     ///< [-] NaN: not known
};

/// Share of the instantaneous force that relaxes within a time [s] after a sudden
/// press, sum_k g_k (1 - exp(-t / tau_k)). @param joint not refused.
[[nodiscard]] RelaxedShare relaxed_within(const JointRelaxation& joint, double time_s);

/// One line for people.
[[nodiscard]] std::string describe(const JointRelaxation& joint);

}  // namespace palpate
