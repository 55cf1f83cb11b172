// The fast process without its clock: device in, fast step, device out, account.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "runtime/device/device.h"
#include "runtime/fast/fast_step.h"
#include "runtime/render/render_report.h"
#include "runtime/render/rendered_body.h"
#include "runtime/render/telemetry.h"
#include "runtime/render/wire_watch.h"

namespace palpate {

struct FastProcessConfig {
  FastConfig fast;
  double rate_hz = 2000.0;      ///< [Hz] > 0
  double stall_s = 0.05;        ///< [s] > 0 without an element: a stall is counted
  double stall_fault_s = 0.5;   ///< [s] > 0 without an element in contact: fault
  double late_fault_s = 0.25;   ///< [s] > 0 of deadlines missed at once: fault
  double silent_fault_s = 0.1;  ///< [s] > 0 of reads with nothing new in a row: fault
  /// [m/s] > 0 faster than a hand moves a tool (and 1 mm): fault. One wrong reading
  /// would be answered with the force of a place where the tool is not.
  double speed_max_m_per_s = std::numeric_limits<double>::infinity();
  WireLimits wire;  ///< beyond them: fault
};

/// Where ticks go beside the device; each may be null.
struct TickOutputs {
  std::vector<RenderTick>* trace = nullptr;  ///< filled up to its capacity
  Telemetry* telemetry = nullptr;
  FlightLog* flight = nullptr;
  TickQueue* watch = nullptr;
};

/// One thread; tick() does not allocate or throw.
class FastProcess {
 public:
  /// All must outlive the process. The device is open.
  FastProcess(const FastProcessConfig& config, Device& device, RenderedBody& body,
              const TickOutputs& outputs)
      : config_(config),
        device_(device),
        body_(body),
        outputs_(outputs),
        wire_(config.wire) {}

  /// read, accept, step, write, publish. False when the run is over: fault or device
  /// lost, after which the force is zero.
  /// @param skipped deadlines that passed without a tick.
  [[nodiscard]] bool tick(std::int64_t skipped) noexcept;

  /// The account so far.
  [[nodiscard]] const RenderReport& report() const noexcept { return report_; }

 private:
  void watch(const DeviceReading& reading, DeviceStatus status,
             std::int64_t skipped) noexcept;
  [[nodiscard]] bool jumped(const DeviceReading& reading) const noexcept;
  void take_in_arrivals(const DeviceReading& reading) noexcept;
  [[nodiscard]] FastCommand timed_step(const DeviceReading& reading) noexcept;
  void account(const DeviceReading& reading, const FastCommand& command) noexcept;
  void account_hand(const DeviceReading& reading, const FastCommand& command) noexcept;
  void record(const DeviceReading& reading, const FastCommand& command,
              std::uint8_t raised) noexcept;

  FastProcessConfig config_;
  Device& device_;
  RenderedBody& body_;
  TickOutputs outputs_;
  RenderReport report_;
  WireWatch wire_;
  DeviceReading last_;
  Eigen::Vector3d held_n_ = Eigen::Vector3d::Zero();  // force since last_
  std::int64_t first_ns_ = 0;
  std::int64_t element_ns_ = 0;  // when the latest element was taken in
  bool stalled_ = false;
  bool withheld_ = false;  // the driver could not render a force whole
  std::int64_t arrivals_ = 0;
  std::int64_t silent_ticks_ = 0;  // reads without an answer, in a row
  std::uint8_t flags_ = 0;         // TickFlag bits known before the step
};

}  // namespace palpate
