// A device that follows a script, keeps every force, and fails on demand.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "formats/base/error.h"
#include "runtime/device/device.h"
#include "runtime/realtime/clock.h"

namespace palpate {

class FakeDevice : public Device {
 public:
  /// Position [m] at a time [s] since the device was opened.
  using Script = std::function<Eigen::Vector3d(double)>;

  FakeDevice(Clock& clock, Script script) : clock_(clock), script_(std::move(script)) {}

  static constexpr std::size_t kNever = static_cast<std::size_t>(-1);
  std::size_t late_read = kNever;    ///< number of the read that has no answer in time
  std::size_t silent_from = kNever;  ///< from this read on no answer is in time
  std::size_t lost_read = kNever;    ///< from this read on the device is gone
  std::size_t lost_write = kNever;   ///< from this write on the device is gone
  bool absent = false;               ///< cannot be opened
  /// Orientation by time [s] since open(); null: not measured.
  std::function<Eigen::Quaterniond(double)> turned;
  std::function<void()> on_write;  ///< called at every write
  /// Called at every read with its number, may change its time [ns].
  std::function<void(std::size_t, std::int64_t&)> on_read;

  [[nodiscard]] std::string name() const override { return "fake"; }
  [[nodiscard]] DeviceLimits limits() const override {
    return {.damping_n_s_per_m = 1.0, .force_max_n = 10.0};
  }

  void open() override {
    if (absent) {
      throw DeviceError("fake device: not attached");
    }
    opened_ns_ = clock_.now_ns();
    open_ = true;
  }

  [[nodiscard]] DeviceStatus read(DeviceReading& reading) noexcept override {
    const std::size_t number = reads_++;
    if (number >= lost_read) {
      return DeviceStatus::kLost;
    }
    reading.time_ns = clock_.now_ns();
    if (on_read) {
      on_read(number, reading.time_ns);
    }
    if (number == late_read || number >= silent_from) {
      return DeviceStatus::kLate;
    }
    const double time_s =
        static_cast<double>(reading.time_ns - opened_ns_) / kNanosecondsPerSecond;
    reading.position_m = script_(time_s);
    if (turned) {
      reading.turn = turned(time_s);
    }
    return DeviceStatus::kOk;
  }

  [[nodiscard]] DeviceStatus write(const Eigen::Vector3d& force_n) noexcept override {
    if (force.size() >= lost_write) {
      return DeviceStatus::kLost;
    }
    force.push_back(force_n);
    if (on_write) {
      on_write();
    }
    return DeviceStatus::kOk;
  }

  void close() noexcept override {
    force.emplace_back(Eigen::Vector3d::Zero());
    open_ = false;
    ++closed;
  }

  [[nodiscard]] bool is_open() const { return open_; }

  std::vector<Eigen::Vector3d> force;  ///< [N] every force that was written
  int closed = 0;

 private:
  Clock& clock_;
  Script script_;
  std::int64_t opened_ns_ = 0;
  std::size_t reads_ = 0;
  bool open_ = false;
};

}  // namespace palpate
