#include "runtime/hand/pointer_hand.h"

#include <cmath>

namespace palpate {

PointerHand::PointerHand(const Eigen::Vector3d& at_m)
    : pointer_m_(at_m), goal_m_(at_m), target_{.position_m = at_m} {}

void PointerHand::advance(double dt_s) noexcept {
  const Eigen::Vector3d way = pointer_m_ - goal_m_;
  const double length = way.norm();
  const double step = kSpeedMPerS * dt_s;
  goal_m_ =
      length > step ? Eigen::Vector3d(goal_m_ + way * (step / length)) : pointer_m_;
  // y = h - g: y(t) = (y0 + (v0 + w y0) t) exp(-w t)
  const double w = kFrequencyPerS;
  const double decay = std::exp(-w * dt_s);
  const Eigen::Vector3d y = target_.position_m - goal_m_;
  const Eigen::Vector3d slope = target_.velocity_m_per_s + w * y;
  target_.position_m = goal_m_ + decay * (y + slope * dt_s);
  target_.velocity_m_per_s = decay * (target_.velocity_m_per_s - w * dt_s * slope);
}

}  // namespace palpate
