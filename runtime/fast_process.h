// The fast process without its clock: device in, fast step, device out, account.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/device.h"
#include "runtime/element_sender.h"
#include "runtime/fast/fast_step.h"
#include "runtime/render_report.h"
#include "runtime/tool_state.h"
#include "runtime/triple_buffer.h"

namespace palpate {

/// What the two processes share.
struct RenderExchange {
  ElementFifo elements;          ///< slow to fast
  TripleBuffer<ToolState> tool;  ///< fast to slow
};

struct FastProcessConfig {
  FastConfig fast;
  double rate_hz = 2000.0;     ///< [Hz] > 0
  double stall_s = 0.05;       ///< [s] > 0 without an element: a stall is counted
  double stall_fault_s = 0.5;  ///< [s] > 0 without an element in contact: fault
  double late_fault_s = 0.25;  ///< [s] > 0 of deadlines missed at once: fault
};

/// One thread; tick() does not allocate or throw. About 80 kB: lives on the heap.
class FastProcess {
 public:
  /// All must outlive the process. The device is open.
  /// @param trace where ticks are recorded up to its capacity; may be null.
  /// @throws InputError if the fast configuration is not valid.
  FastProcess(const FastProcessConfig& config, Device& device, RenderExchange& exchange,
              std::vector<RenderTick>* trace);

  /// read, accept, step, write, publish. False when the run is over: fault or device
  /// lost, after which the force is zero.
  /// @param skipped deadlines that passed without a tick.
  [[nodiscard]] bool tick(std::int64_t skipped) noexcept;

  /// The account so far.
  [[nodiscard]] const RenderReport& report() const noexcept { return report_; }

 private:
  void watch(const DeviceReading& reading, std::int64_t skipped) noexcept;
  [[nodiscard]] FastCommand timed_step(const DeviceReading& reading) noexcept;
  void account(const DeviceReading& reading, const FastCommand& command) noexcept;
  void publish(const DeviceReading& reading) noexcept;

  FastProcessConfig config_;
  Device& device_;
  RenderExchange& exchange_;
  std::vector<RenderTick>* trace_;
  FastState state_;
  RenderReport report_;
  DeviceReading last_;
  Eigen::Vector3d held_n_ = Eigen::Vector3d::Zero();  // force since last_
  std::int64_t first_ns_ = 0;
  std::int64_t element_ns_ = 0;  // when the latest element was taken in
  bool stalled_ = false;
};

}  // namespace palpate
