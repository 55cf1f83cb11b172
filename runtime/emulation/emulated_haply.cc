#include "runtime/emulation/emulated_haply.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate {
namespace {

constexpr double kRadian = 180.0 / std::numbers::pi;  // [degrees]

}  // namespace

HaplyModel::HaplyModel(const HaplyModelConfig& config)
    : SerialBoard(config.dynamics, config.hand, config.start_m, config.split_bytes,
                  config.trace_max),
      config_(config) {}

int HaplyModel::send(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  port.clock.set(now_ns);
  port.heard.insert(port.heard.end(), bytes.begin(), bytes.end());
  for (;;) {
    // The first byte says what comes, and so how long it is: 0 reset, 1 set-up, 2
    // torques. A byte of another value is passed over.
    const std::uint8_t order = port.heard.empty() ? 0xFF : port.heard[0];
    const std::size_t length = order == 0   ? kHaplyResetBytes
                               : order == 1 ? kHaplySetupBytes
                                            : kHaplyTorqueBytes;
    if (port.heard.size() < length) {
      return static_cast<int>(bytes.size());
    }
    if (order == 1) {
      set_up_ = true;
      id_ = port.heard[1];
    } else if (order == 2 && set_up_) {
      std::array<std::uint8_t, kHaplyTorqueBytes> command{};
      std::copy_n(port.heard.begin(), command.size(), command.begin());
      torque_nm_ = decode_torques(command);
      obey(now_ns);
    } else if (order == 0) {
      torque_nm_ = {};
    }
    const bool known = order <= 2;
    port.heard.erase(port.heard.begin(),
                     port.heard.begin() +
                         static_cast<std::ptrdiff_t>(known ? length : std::size_t{1}));
  }
}

// As an encoder counts it.
double HaplyModel::counted_deg(double theta_rad) const {
  const double count_rad = 2.0 * std::numbers::pi / config_.counts_per_turn;
  return kRadian * (config_.counts_per_turn > 0.0
                        ? count_rad * std::round(theta_rad / count_rad)
                        : theta_rad);
}

void HaplyModel::obey(std::int64_t now_ns) {
  static_cast<void>(look());
  Eigen::Vector2d theta;
  const bool reached =
      inverse(config_.links, tool().motion().position_m.head<2>(), theta) &&
      forward(config_.links, theta, pose_);
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  if (reached) {
    force.head<2>() = force_of(pose_, {torque_nm_[0], torque_nm_[1]});
  }
  push(force, now_ns);
  const auto reply =
      encode_angles(id_, {counted_deg(pose_.theta[0]), counted_deg(pose_.theta[1])});
  port.ready_ns = now_ns + config_.answer_ns;
  port.waiting.insert(port.waiting.end(), reply.begin(), reply.end());
}

}  // namespace palpate
