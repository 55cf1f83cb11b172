// What a measurement says of time: relaxation while held, loss over a loop.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <string>

#include "fitting/curve/joint_relaxation.h"
#include "fitting/curve/power_law_fit.h"
#include "formats/database/response_database.h"

namespace palpate {

/// What the hold shows: F(t) = F(0) (g_inf + g_1 exp(-t / tau_1) + g_2 exp(-t /
/// tau_2)), g_inf + g_1 + g_2 = 1, t from the start of the hold. The press before it
/// counts as a step: what relaxed meanwhile is missing, and the terms hold after a
/// press at about this speed. `joint` has those of the material, without what the speed
/// makes of them.
struct Relaxation {
  std::string refused;            ///< why there is none; empty where there is
  double force_n = 0.0;           ///< [N] F(0)
  double g_inf = 1.0;             ///< [-] of F(0), what stays
  std::array<double, 2> g{};      ///< [-]
  std::array<double, 2> tau_s{};  ///< [s] rising
  std::array<double, 2> tau_sd_s{};
  double end_over_start = 1.0;  ///< [-] as measured
  double rms_relative = 0.0;    ///< [-] of the residuals, over F(0)
  double seconds = 0.0;         ///< [s] length of the hold
  /// [m/s] mean over the last half of the press before the hold; NaN: not pressed
  double speed_m_per_s = std::numeric_limits<double>::quiet_NaN();
  bool converged = false;
  JointRelaxation joint;  ///< of press and hold together; refused where there is none
};

/// @param time_s, force_n (n) of one hold, n >= 12. @throws InputError for other
/// counts.
[[nodiscard]] Relaxation fit_relaxation(std::span<const double> time_s,
                                        std::span<const double> force_n);

/// The hold of a measurement in which the force falls for longest. `joint` is of the
/// whole way, from where the tool last left the shallowest 5 % of the travel before
/// that hold. The way has all ramps and holds up to the last before the tool goes back.
/// Where the same model follows the release and holds after that, these are included
/// while a thirtieth of the force is left. Refused without time or without a hold of 12
/// samples.
[[nodiscard]] Relaxation find_relaxation(const Measurement& measurement);

/// find_relaxation() of a press that stands still twice or more, deeper than the
/// shallowest 5 % of its travel: several ramps and holds. None of other presses, whose
/// law the fit of the approach follows, and none without time.
/// @param approach of the same press; its sign tells which way is compression.
[[nodiscard]] std::optional<Relaxation> find_stepwise_relaxation(
    const Measurement& measurement, const Approach& approach);

/// F = K d^p (1 + lambda d'), d' the speed of pressing (Hunt and Crossley 1975).
struct LoopFit {
  std::string refused;  ///< why there is none; the works may stand nevertheless
  double press_work_j = 0.0, release_work_j = 0.0;
  double loss_factor = std::numeric_limits<double>::quiet_NaN();
  ///< [-] lost work over pi times the sum of press and release work
  double coefficient = 0.0;     ///< [N/m^p] K
  double exponent = 0.0;        ///< [-] p
  double lambda_s_per_m = 0.0;  ///< [s/m]
  double lambda_sd_s_per_m = 0.0;
  double rms_n = 0.0;
};

/// With the contact point and baseline of `fit`. Refused, and the loss factor NaN, for
/// a loop that is not passive; Hunt-Crossley is refused without time.
[[nodiscard]] LoopFit find_loop(const Measurement& measurement,
                                const Approach& approach, const ContactFit& fit);

}  // namespace palpate
