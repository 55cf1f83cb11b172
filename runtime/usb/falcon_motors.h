// From a force on the Falcon's tool to motor commands, and back for an emulated one.
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace palpate {

/// Largest motor command, of either sign [motor counts].
constexpr double kFalconMotorMax = 4095.0;

/// Motor counts per N m of joint torque, of a Falcon as it is usually found. Empirical.
constexpr double kFalconCountsPerNewtonMetre = -10'000.0;

struct FalconMotors {
  std::array<std::int16_t, 3> command{};  ///< [motor counts] within kFalconMotorMax
  bool clamped = false;                   ///< the force was more than the motors have
};

/// Commands for a force [N] on the tool at a pose: joint torques rates^-T F times the
/// gain. Where a motor would exceed its largest command, all three shrink by one
/// factor, so that the direction stays. Zero where the force is not finite or the
/// rates are singular.
/// @param rates       [rad/m] d theta1 / d position.
/// @param calibration [-] > 0 force asked for per force measured at calibration 1.
[[nodiscard]] FalconMotors motors_for(const Eigen::Vector3d& force_n,
                                      const Eigen::Matrix3d& rates,
                                      double calibration) noexcept;

/// Force [N] on the tool of commands: rates^T torque.
[[nodiscard]] Eigen::Vector3d force_of(const std::array<std::int16_t, 3>& command,
                                       const Eigen::Matrix3d& rates,
                                       double calibration) noexcept;

}  // namespace palpate
