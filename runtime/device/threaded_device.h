// A device whose protocol runs in a thread of its own, at the device's own rate.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "runtime/device/device.h"
#include "runtime/device/device_link.h"
#include "runtime/device/link_report.h"
#include "runtime/realtime/triple_buffer.h"

namespace palpate {

struct LinkTiming {
  double rate_max_hz = 4000.0;  ///< [Hz] > 0; a device that is faster waits
  /// [s] >= 0 that the next exchange waits for the force that answers the last one's
  /// position. A Falcon's reply waits for its timer longer than that.
  double answer_s = 3e-4;
  double silent_s = 0.02;  ///< [s] > 0 without write(): zero force until the next
  double stale_s = 0.01;   ///< [s] > 0 a reading that old is no answer any more
};

/// The fast loop's read() and write() only exchange the latest values, wait-free. The
/// thread transacts; when the fast loop falls silent it sends zero force, for boards
/// have no watchdog of their own. Every way out of the thread closes the link.
class LinkedDevice : public Device {
 public:
  LinkedDevice(std::unique_ptr<DeviceLink> link, const LinkTiming& timing);
  ~LinkedDevice() override;

  [[nodiscard]] std::string name() const override { return link_->name(); }
  [[nodiscard]] DeviceLimits limits() const override { return link_->limits(); }
  [[nodiscard]] bool measures_turns() const override { return link_->measures_turns(); }
  void open() override;
  [[nodiscard]] DeviceStatus read(DeviceReading& reading) noexcept override;
  [[nodiscard]] DeviceStatus write(const Eigen::Vector3d& force_n) noexcept override;
  void close() noexcept override;
  [[nodiscard]] std::string failure() const override;

  [[nodiscard]] const LinkReport* wire() const override { return &report_; }

 private:
  struct Command {
    Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
    std::int64_t time_ns = 0;
    std::int64_t measured_ns = 0;  // when the position was that it answers
  };
  struct Measured {
    DeviceReading reading;
    std::int64_t begin_ns = 0;  // of the exchange
  };

  void run() noexcept;
  [[nodiscard]] Command wanted(std::int64_t now_ns) noexcept;
  void await_answer(std::int64_t measured_ns) noexcept;

  std::unique_ptr<DeviceLink> link_;
  LinkTiming timing_;
  TripleBuffer<Command> command_;
  TripleBuffer<Measured> reading_;
  std::atomic<bool> stop_ = false;
  std::atomic<bool> lost_ = false;
  bool silent_ = false;
  LinkReport report_;
  std::thread thread_;
};

}  // namespace palpate
