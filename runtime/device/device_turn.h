// How a device is turned, from what it says of it.
#pragma once

#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace palpate {

/// How far from a rotation [-] what a device says may be: rounded to four digits it is
/// nearer, and anything farther is no rounding.
constexpr double kTurnTolerance = 0.01;

/// The rotation that was said, made exact. A quaternion whose norm is 1 within
/// kTurnTolerance is divided by the norm. A matrix whose M^T M is the identity within
/// that tolerance and whose determinant is positive is made a rotation. Nothing else
/// is: no number, zero, another norm, a mirror.
[[nodiscard]] std::optional<Eigen::Quaterniond> exact_turn(
    const Eigen::Quaterniond& said) noexcept;
[[nodiscard]] std::optional<Eigen::Quaterniond> exact_turn(
    const Eigen::Matrix3d& said) noexcept;

/// A grip's own zero is anywhere (an inertial sensor's heading, a stylus in its rest).
/// What it is turned by from how it was held first, about the device's axes: the tool
/// is upright as the hand begins.
class TurnFromStart {
 public:
  /// Unit quaternions.
  Eigen::Quaterniond operator()(const Eigen::Quaterniond& turn) noexcept {
    if (!begun_) {
      begun_ = true;
      to_start_ = turn.conjugate();
    }
    return (turn * to_start_).normalized();
  }

 private:
  bool begun_ = false;
  Eigen::Quaterniond to_start_ = Eigen::Quaterniond::Identity();
};

}  // namespace palpate
