// A hand that follows a pointer, as the simulated device's hand.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "runtime/hand/hand_script.h"

namespace palpate {

/// Critically damped follower: h'' = w^2 (g - h) - 2 w h', where the goal g runs after
/// the pointer at kSpeedMPerS at most. Whatever the pointer does, the hand moves
/// smoothly, no faster than that, and never past it. Its wrist turns likewise towards
/// the orientation that is asked for.
class PointerHand {
 public:
  static constexpr double kSpeedMPerS = 0.25;     ///< [m/s] about a palpating hand's
  static constexpr double kFrequencyPerS = 40.0;  ///< [1/s] w: follows within 50 ms

  static constexpr double kTurnRadPerS = 3.0;      ///< [rad/s] of the wrist at most
  static constexpr double kTurnFollowPerS = 25.0;  ///< [1/s] as it comes near

  explicit PointerHand(const Eigen::Vector3d& at_m,
                       const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity());

  /// Where the pointer is [m].
  void point_at(const Eigen::Vector3d& pointer_m) noexcept { pointer_m_ = pointer_m; }

  /// How the tool shall be turned [-], body from tool.
  void turn_to(const Eigen::Quaterniond& turn) noexcept { wanted_turn_ = turn; }

  /// Exact for a goal held constant over dt_s [s] > 0.
  void advance(double dt_s) noexcept;

  /// Stays in place, so that a device may keep hold of it.
  [[nodiscard]] const HandTarget& target() const noexcept { return target_; }
  [[nodiscard]] const Eigen::Vector3d& pointer_m() const noexcept { return pointer_m_; }
  [[nodiscard]] const Eigen::Quaterniond& wanted_turn() const noexcept {
    return wanted_turn_;
  }

 private:
  Eigen::Vector3d pointer_m_;
  Eigen::Vector3d goal_m_;
  Eigen::Quaterniond wanted_turn_;
  HandTarget target_;
};

}  // namespace palpate
