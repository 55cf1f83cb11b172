#include "runtime/emulation/emulated_haply.h"

#include <algorithm>
#include <cerrno>
#include <numbers>

namespace palpate {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr double kRadian = 180.0 / std::numbers::pi;  // [degrees]

}  // namespace

HaplyModel::HaplyModel(const HaplyModelConfig& config)
    : config_(config),
      tool_(config.dynamics, config.hand, clock_, {.position_m = config.start_m}) {
  trace_.reserve(config.trace_max);
}

// Line coding and control lines are of no consequence.
int HaplyModel::control(const UsbSetup& setup, std::int64_t /*now_ns*/) {
  return (setup.request_type & 0x60) == 0x20 ? 0 : -EPIPE;
}

int HaplyModel::send(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  clock_.set(now_ns);
  heard_.insert(heard_.end(), bytes.begin(), bytes.end());
  for (;;) {
    const std::uint8_t order = heard_.empty() ? 0xFF : heard_[0];
    const std::size_t length = order == 0   ? kHaplyResetBytes
                               : order == 1 ? kHaplySetupBytes
                                            : kHaplyTorqueBytes;
    if (heard_.size() < length) {
      return static_cast<int>(bytes.size());
    }
    if (order == 1) {
      set_up_ = true;
      id_ = heard_[1];
    } else if (order == 2 && set_up_) {
      std::array<std::uint8_t, kHaplyTorqueBytes> command{};
      std::copy_n(heard_.begin(), command.size(), command.begin());
      torque_nm_ = decode_torques(command);
      obey(now_ns);
    } else if (order == 0) {
      torque_nm_ = {};
    }
    const bool known = order <= 2;
    heard_.erase(heard_.begin(), heard_.begin() + static_cast<std::ptrdiff_t>(
                                                      known ? length : std::size_t{1}));
  }
}

void HaplyModel::obey(std::int64_t now_ns) {
  if (!opened_) {
    tool_.open();
    opened_ = true;
  }
  DeviceReading at;
  static_cast<void>(tool_.read(at));
  Eigen::Vector2d theta;
  const bool reached =
      inverse(config_.links, tool_.motion().position_m.head<2>(), theta) &&
      forward(config_.links, theta, pose_);
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  if (reached) {
    force.head<2>() = force_of(pose_, {torque_nm_[0], torque_nm_[1]});
  }
  static_cast<void>(tool_.write(force));
  if (trace_.size() < config_.trace_max) {
    trace_.push_back(motor_record(tool_, now_ns));
  }
  const auto reply =
      encode_angles(id_, {kRadian * pose_.theta[0], kRadian * pose_.theta[1]});
  ready_ns_ = now_ns + config_.answer_ns;
  waiting_.insert(waiting_.end(), reply.begin(), reply.end());
}

int HaplyModel::receive(std::span<std::uint8_t> packet, std::int64_t now_ns) {
  if (waiting_.empty() || now_ns < ready_ns_) {
    return -EAGAIN;
  }
  std::size_t count = 0;
  while (count < std::min(packet.size(), config_.split_bytes) && !waiting_.empty()) {
    packet[count++] = waiting_.front();
    waiting_.pop_front();
  }
  return static_cast<int>(count);
}

std::int64_t HaplyModel::next_ns(std::int64_t now_ns) {
  return waiting_.empty() ? now_ns + kMillisecond : ready_ns_;
}

std::unique_ptr<HaplyLink> EmulatedHaply::link(
    const std::shared_ptr<EmulatedHaply>& haply, const HaplyConfig& config) {
  return std::make_unique<HaplyLink>(
      config,
      [haply] {
        haply->usb_ = std::make_unique<EmulatedUsb>(haply->bus_);
        return haply->usb_->descriptor();
      },
      [haply](int /*descriptor*/) {
        haply->kernel_driver_ = haply->usb_->kernel_driver();
        haply->usb_.reset();
      });
}

}  // namespace palpate
