#include "runtime/hand/simulated_device.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kStepS =
    static_cast<double>(SimulatedDevice::kStepNs) / kNanosecondsPerSecond;

// exp(a) by Taylor's series of a / 16, squared four times; rounding grows by 16.
Eigen::Matrix4d exponential(const Eigen::Matrix4d& a) {
  constexpr int kSquarings = 4;
  const Eigen::Matrix4d small = a / (1 << kSquarings);
  Eigen::Matrix4d term = Eigen::Matrix4d::Identity();
  Eigen::Matrix4d sum = term;
  for (int i = 1; i <= 20; ++i) {
    term = term * small / i;
    sum += term;
  }
  for (int i = 0; i < kSquarings; ++i) {
    sum = sum * sum;
  }
  return sum;
}

void check_device_value(const char* what, double value, bool zero_allowed) {
  const bool ok = zero_allowed ? value >= 0.0 : value > 0.0;
  if (!ok || !std::isfinite(value)) {
    throw InputError(fmt::format("simulated device: {} is {}, must be {} and finite",
                                 what, value,
                                 zero_allowed ? "zero or more" : "positive"));
  }
}

double quantised(double value, double resolution) noexcept {
  return resolution > 0.0 ? resolution * std::round(value / resolution) : value;
}

}  // namespace

void check(const SimulatedDeviceConfig& config) {
  check_device_value("mass_kg", config.mass_kg, false);
  check_device_value("damping_n_s_per_m", config.damping_n_s_per_m, true);
  check_device_value("coulomb_n", config.coulomb_n, true);
  check_device_value("load_n_per_m", config.load_n_per_m, true);
  check_device_value("load_n_s_per_m", config.load_n_s_per_m, false);
  check_device_value("resolution_m", config.resolution_m, true);
  check_device_value("hand_n_per_m", config.hand_n_per_m, true);
  check_device_value("hand_n_s_per_m", config.hand_n_s_per_m, true);
  check_device_value("force_max_n", config.force_max_n, false);
  check_device_value("tick_s", config.tick_s, false);
  if (config.delay_ticks < 0 || config.delay_ticks > static_cast<int>(kDelayTicksMax)) {
    throw InputError(
        fmt::format("simulated device: delay_ticks is {}, must lie in [0, {}]",
                    config.delay_ticks, kDelayTicksMax));
  }
}

SimulatedDevice::SimulatedDevice(const SimulatedDeviceConfig& config,
                                 const HandScript& script, Clock& clock,
                                 const SimulatedMotion& start)
    : config_(config), script_(script), clock_(clock), motion_(start) {
  check(config);
  const double m = config.mass_kg;
  Eigen::Matrix4d a = Eigen::Matrix4d::Zero();  // over (x, v, s, force)
  a(0, 1) = 1.0;
  a(1, 0) = -config.hand_n_per_m / m;
  a(1, 1) = -(config.damping_n_s_per_m + config.hand_n_s_per_m) / m;
  a(1, 2) = -config.load_n_per_m / m;
  a(1, 3) = 1.0 / m;
  a(2, 1) = 1.0;
  a(2, 2) = -config.load_n_per_m / config.load_n_s_per_m;
  const Eigen::Matrix4d solution = exponential(a * kStepS);
  transition_ = solution.topLeftCorner<3, 3>();
  response_ = solution.topRightCorner<3, 1>();
}

SimulatedDevice::SimulatedDevice(const SimulatedDeviceConfig& config,
                                 const HandTarget& hand, Clock& clock,
                                 const SimulatedMotion& start)
    : SimulatedDevice(config, HandScript{}, clock, start) {
  hand_ = &hand;
}

DeviceLimits SimulatedDevice::limits() const {
  return {.damping_n_s_per_m = config_.damping_n_s_per_m,
          .coulomb_n = config_.coulomb_n,
          .resolution_m = config_.resolution_m,
          .delay_s = config_.delay_ticks * config_.tick_s,
          .force_max_n = config_.force_max_n};
}

void SimulatedDevice::open() {
  opened_ns_ = clock_.now_ns();
  steps_ = 0;
  writes_ = 0;
  rendered_work_j_ = 0.0;
  path_m_ = 0.0;
  squared_speed_m2_per_s_ = 0.0;
  acting_n_.setZero();
  queue_.fill(Eigen::Vector3d::Zero());
}

void SimulatedDevice::advance() noexcept {
  const std::int64_t due = (clock_.now_ns() - opened_ns_) / kStepNs;
  for (; steps_ < due; ++steps_) {
    step();
  }
}

void SimulatedDevice::step() noexcept {
  const HandTarget hand =
      hand_ != nullptr ? *hand_
                       : script_.at((static_cast<double>(steps_) + 0.5) * kStepS);
  const Eigen::Vector3d pull = acting_n_ + config_.hand_n_per_m * hand.position_m +
                               config_.hand_n_s_per_m * hand.velocity_m_per_s;
  Eigen::Matrix3d state;  // one column per axis
  state << motion_.position_m.transpose(), motion_.velocity_m_per_s.transpose(),
      motion_.load_stretch_m.transpose();
  Eigen::Matrix3d next = transition_ * state + response_ * pull.transpose();

  // The friction force that would stop the tool at the end of the step, if it can.
  Eigen::Vector3d friction = -next.row(1).transpose() / response_[1];
  const double needed = friction.norm();
  if (needed > config_.coulomb_n) {
    friction *= config_.coulomb_n / needed;
  }
  next += response_ * friction.transpose();

  const Eigen::Vector3d before = motion_.position_m;
  motion_.position_m = next.row(0).transpose();
  motion_.velocity_m_per_s = next.row(1).transpose();
  motion_.load_stretch_m = next.row(2).transpose();
  const Eigen::Vector3d moved = motion_.position_m - before;
  rendered_work_j_ += acting_n_.dot(moved);
  path_m_ += moved.norm();
  squared_speed_m2_per_s_ += moved.squaredNorm() / kStepS;
}

DeviceStatus SimulatedDevice::read(DeviceReading& reading) noexcept {
  advance();
  reading.time_ns = clock_.now_ns();
  for (int axis = 0; axis < 3; ++axis) {
    reading.position_m[axis] =
        quantised(motion_.position_m[axis], config_.resolution_m);
  }
  if (hand_ != nullptr) {
    reading.turn = hand_->turn;
  } else if (wrist_) {
    reading.turn = wrist_->at(seconds_in(reading.time_ns - opened_ns_));
  }
  return DeviceStatus::kOk;
}

DeviceStatus SimulatedDevice::write(const Eigen::Vector3d& force_n) noexcept {
  advance();
  const auto delay = static_cast<std::size_t>(config_.delay_ticks);
  queue_[writes_ % queue_.size()] = force_n;
  if (writes_ >= delay) {
    acting_n_ = queue_[(writes_ - delay) % queue_.size()];
  }
  const double length = acting_n_.norm();
  if (length > config_.force_max_n) {
    acting_n_ *= config_.force_max_n / length;
  }
  ++writes_;
  return DeviceStatus::kOk;
}

void SimulatedDevice::close() noexcept {
  acting_n_.setZero();
  queue_.fill(Eigen::Vector3d::Zero());
}

}  // namespace palpate
