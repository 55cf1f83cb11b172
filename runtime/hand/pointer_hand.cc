#include "runtime/hand/pointer_hand.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

Eigen::Quaterniond turned_by_wrist(const Eigen::Quaterniond& now,
                                   const Eigen::Quaterniond& wanted, double dt_s) {
  const double angle = now.angularDistance(wanted);
  if (!(angle > 1e-9)) {
    return now;
  }
  const double follow = 1.0 - std::exp(-PointerHand::kTurnFollowPerS * dt_s);
  const double most = PointerHand::kTurnRadPerS * dt_s / angle;
  return now.slerp(std::min(follow, most), wanted).normalized();
}

}  // namespace

PointerHand::PointerHand(const Eigen::Vector3d& at_m, const Eigen::Quaterniond& turn)
    : pointer_m_(at_m),
      goal_m_(at_m),
      wanted_turn_(turn),
      target_{.position_m = at_m, .turn = turn} {}

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
  target_.turn = turned_by_wrist(target_.turn, wanted_turn_, dt_s);
}

}  // namespace palpate
