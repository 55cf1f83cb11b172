// A simulated device as a probe meets it: behind an exchange, held by nobody.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>

#include <Eigen/Core>

#include "runtime/device/device_link.h"
#include "runtime/hand/simulated_device.h"
#include "runtime/realtime/clock.h"

namespace palpate {

/// Nobody holds it.
inline SimulatedDeviceConfig let_go() {
  SimulatedDeviceConfig config;
  config.hand_n_per_m = 0.0;
  config.hand_n_s_per_m = 0.0;
  return config;
}

/// A simulated device behind an exchange of 0.2 ms, in whose middle forces change and
/// positions are measured.
class SimulatedLink : public DeviceLink {
 public:
  SimulatedLink(const SimulatedDeviceConfig& config, const HandTarget& hand)
      : device_(config, hand, clock, {}) {}

  [[nodiscard]] std::string name() const override { return "simulated"; }
  [[nodiscard]] DeviceLimits limits() const override { return device_.limits(); }
  void open() override { device_.open(); }
  [[nodiscard]] LinkStatus transact(const Eigen::Vector3d& force_n,
                                    Eigen::Vector3d& position_m) noexcept override {
    constexpr std::int64_t kHalfNs = 100'000;
    clock.sleep_until_ns(clock.now_ns() + kHalfNs);
    if (exchanged) {
      exchanged();
    }
    sent_n_ = gain * force_n;
    force_max_n = std::max(force_max_n, sent_n_.norm());
    static_cast<void>(device_.write(sent_n_));
    DeviceReading reading;
    static_cast<void>(device_.read(reading));
    position_m = reading.position_m;
    clock.sleep_until_ns(clock.now_ns() + kHalfNs);
    return lost ? LinkStatus::kLost : LinkStatus::kOk;
  }
  [[nodiscard]] Eigen::Vector3d sent_n() const noexcept override { return sent_n_; }
  void close() noexcept override {}
  [[nodiscard]] std::string failure() const override { return "gone"; }

  SimulatedClock clock;
  [[nodiscard]] const SimulatedMotion& motion() const { return device_.motion(); }

  std::function<void()> exchanged;
  double gain = 1.0;
  bool lost = false;
  double force_max_n = 0.0;

 private:
  SimulatedDevice device_;
  Eigen::Vector3d sent_n_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate
