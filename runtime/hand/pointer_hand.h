// A hand that follows a pointer, as the simulated device's hand.
#pragma once

#include <Eigen/Core>

#include "runtime/hand/hand_script.h"

namespace palpate {

/// Critically damped follower: h'' = w^2 (g - h) - 2 w h', where the goal g runs after
/// the pointer at kSpeedMPerS at most. Whatever the pointer does, the hand moves
/// smoothly, no faster than that, and never past it.
class PointerHand {
 public:
  static constexpr double kSpeedMPerS = 0.25;     ///< [m/s] about a palpating hand's
  static constexpr double kFrequencyPerS = 40.0;  ///< [1/s] w: follows within 50 ms

  explicit PointerHand(const Eigen::Vector3d& at_m);

  /// Where the pointer is [m].
  void point_at(const Eigen::Vector3d& pointer_m) noexcept { pointer_m_ = pointer_m; }

  /// Exact for a goal held constant over dt_s [s] > 0.
  void advance(double dt_s) noexcept;

  /// Stays in place, so that a device may keep hold of it.
  [[nodiscard]] const HandTarget& target() const noexcept { return target_; }
  [[nodiscard]] const Eigen::Vector3d& pointer_m() const noexcept { return pointer_m_; }

 private:
  Eigen::Vector3d pointer_m_;
  Eigen::Vector3d goal_m_;
  HandTarget target_;
};

}  // namespace palpate
