#include "runtime/hand/wandering_hand.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "formats/base/error.h"

namespace palpate {
namespace {

Eigen::Vector3d flat(const Eigen::Vector3d& v, const Eigen::Vector3d& outward) {
  const Eigen::Vector3d along = v - v.dot(outward) * outward;
  return along.norm() > 1e-9 ? along.normalized() : outward.unitOrthogonal();
}

}  // namespace

WanderingHand::WanderingHand(const SurfaceMesh& body, const Points& normal,
                             std::vector<bool> open, const WanderOptions& options)
    : body_(body),
      normal_(normal),
      open_(std::move(open)),
      o_(options),
      search_(body),
      random_(options.seed) {
  double highest = -std::numeric_limits<double>::infinity();
  for (std::int32_t t = 0; t < body_.triangle.rows(); ++t) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (Eigen::Index j = 0; j < 3; ++j) {
      middle += body_.position_m.row(body_.triangle(t, j)).transpose() / 3.0;
    }
    if (is_open(t) && middle.z() > highest) {
      highest = middle.z();
      at_ = search_.walk(middle, t);
    }
  }
  if (at_.triangle < 0) {
    throw InputError("no triangle of the body has three nodes to wander over");
  }
  aim(0.0);
}

bool WanderingHand::is_open(std::int32_t triangle) const {
  const auto corner = [&](Eigen::Index j) {
    return open_[static_cast<std::size_t>(body_.triangle(triangle, j))];
  };
  return triangle >= 0 && corner(0) && corner(1) && corner(2);
}

// The target over the present place.
void WanderingHand::aim(double dt_s) {
  outward_.setZero();
  for (Eigen::Index j = 0; j < 3; ++j) {
    outward_ += at_.area_coordinate(j) *
                normal_.row(body_.triangle(at_.triangle, j)).transpose();
  }
  outward_.normalize();
  heading_ = flat(heading_, outward_);
  const double above = std::max(0.0, 1.0 - time_s_ / o_.lower_s);
  const Eigen::Vector3d from = target_.position_m;
  target_.position_m =
      at_.position_m +
      (o_.touch_m - o_.press_m + above * (o_.press_m + o_.clear_m)) * outward_;
  target_.velocity_m_per_s = dt_s > 0.0 ? ((target_.position_m - from) / dt_s).eval()
                                        : Eigen::Vector3d::Zero().eval();
}

void WanderingHand::advance(double dt_s) {
  time_s_ += dt_s;
  const double turn = o_.turn_rad_per_s * std::sqrt(dt_s) * drift_(random_);
  heading_ = Eigen::AngleAxisd(turn, outward_) * heading_;
  const SurfacePoint to =
      search_.walk(at_.position_m + o_.speed_m_per_s * dt_s * heading_, at_.triangle);
  if (is_open(to.triangle)) {
    at_ = to;
  } else {  // at the rim: about and on, a little to the side
    const double back = std::numbers::pi * (1.0 + 0.25 * drift_(random_));
    heading_ = Eigen::AngleAxisd(back, outward_) * heading_;
  }
  aim(dt_s);
}

WanderingDevice::WanderingDevice(const SimulatedDeviceConfig& config,
                                 WanderingHand hand, Clock& clock)
    : hand_(std::move(hand)),
      clock_(clock),
      device_(config, hand_.target(), clock,
              SimulatedMotion{.position_m = hand_.target().position_m}) {}

void WanderingDevice::open() {
  advanced_ns_ = clock_.now_ns();
  device_.open();
}

DeviceStatus WanderingDevice::read(DeviceReading& reading) noexcept {
  constexpr std::int64_t kStepNs = 500'000;
  const std::int64_t now_ns = clock_.now_ns();
  for (; advanced_ns_ + kStepNs <= now_ns; advanced_ns_ += kStepNs) {
    hand_.advance(static_cast<double>(kStepNs) / kNanosecondsPerSecond);
  }
  return device_.read(reading);
}

}  // namespace palpate
