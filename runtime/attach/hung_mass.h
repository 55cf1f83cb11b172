// How much force a device must be asked for to carry what hangs on it.
#pragma once

#include <atomic>

#include "runtime/device/device_link.h"

namespace palpate {

/// Of what hangs, standard [m/s^2].
constexpr double kGravity = 9.80665;

struct WeighOptions {
  double stiffness_n_per_m = 150.0;  ///< [N/m] > 0 of the spring that carries
  double damping_n_s_per_m = 0.5;    ///< [N s/m] >= 0 beside the mechanism's own
  double sweep_m = 0.004;            ///< [m] > 0 up and down
  double period_s = 2.0;             ///< [s] > 0 of the sweep
  int periods = 4;                   ///< >= 2 that are averaged
  double settle_s = 3.0;  ///< [s] > 0 before them; for half of it the spring comes
};

/// Force asked for along the device's y axis [N], upwards.
struct Weight {
  double force_n = 0.0;
  double sd_n = 0.0;  ///< standard deviation of the mean, from the periods
};

/// Carries the tool on a spring about `centre_m`, sweeps it up and down, and averages
/// the force over whole periods. Dry friction, damping and inertia cancel. Nobody holds
/// the tool. @param link open. @param stop ends it. @throws DeviceError if the link is
/// lost, answers fewer than half of the exchanges, or the tool runs away from its
/// spring (wrong signs). Then the link is at zero force. @throws Interrupted when
/// stopped. The caller then closes the link, which until then holds the last force.
[[nodiscard]] Weight weigh(DeviceLink& link, const Eigen::Vector3d& centre_m,
                           const WeighOptions& options, const std::atomic<bool>& stop);

/// Factor on motor commands [-] from the force asked for with and without `mass_kg` on
/// the tool, at factor 1. Where the motors give less, more force was asked for than the
/// mass weighs. The weight of the mechanism cancels. @param sd of the factor.
/// @throws DeviceError for a factor outside [0.2, 5], which no device has.
[[nodiscard]] double factor_of(const Weight& bare, const Weight& loaded, double mass_kg,
                               double& sd);

}  // namespace palpate
