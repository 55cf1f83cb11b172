// A device whose tool is where a file says, tick by tick, and that pushes nobody.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "runtime/device/device.h"
#include "runtime/render/render_report.h"

namespace palpate {

/// Gives one pose a read; after the last one it stays there.
class PosedDevice : public Device {
 public:
  /// @param ticks at least one. @param hand of each, whose pose it gives.
  PosedDevice(std::shared_ptr<const std::vector<RenderTick>> ticks, std::size_t hand,
              const DeviceLimits& limits)
      : ticks_(std::move(ticks)), hand_(hand), limits_(limits) {}

  [[nodiscard]] std::string name() const override { return "poses"; }
  [[nodiscard]] DeviceLimits limits() const override { return limits_; }
  [[nodiscard]] bool measures_turns() const override { return true; }
  void open() override { next_ = 0; }
  [[nodiscard]] DeviceStatus read(DeviceReading& reading) noexcept override {
    const RenderTick& tick = (*ticks_)[next_];
    next_ += next_ + 1 < ticks_->size() ? 1 : 0;
    reading.time_ns = tick.time_ns;
    reading.position_m = tick.pose[hand_].position_m;
    reading.turn = tick.pose[hand_].turn;
    return DeviceStatus::kOk;
  }
  [[nodiscard]] DeviceStatus write(const Eigen::Vector3d& force_n) noexcept override {
    static_cast<void>(force_n);
    return DeviceStatus::kOk;
  }
  void close() noexcept override {}

 private:
  std::shared_ptr<const std::vector<RenderTick>> ticks_;
  std::size_t hand_;
  DeviceLimits limits_;
  std::size_t next_ = 0;
};

}  // namespace palpate
