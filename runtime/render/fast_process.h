// The fast process without its clock: device in, fast step, device out, account.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "runtime/device/device.h"
#include "runtime/fast/fast_step.h"
#include "runtime/fast/switch_model.h"
#include "runtime/realtime/triple_buffer.h"
#include "runtime/render/render_report.h"
#include "runtime/render/surface_dents.h"
#include "runtime/render/telemetry.h"
#include "runtime/slow/element_source.h"
#include "runtime/slow/tool_state.h"

namespace palpate {

/// What the two processes share.
struct RenderExchange {
  ElementFifo elements;          ///< slow to fast
  TripleBuffer<ToolState> tool;  ///< fast to slow
};

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
};

/// Where ticks go beside the device; each may be null.
struct TickOutputs {
  std::vector<RenderTick>* trace = nullptr;  ///< filled up to its capacity
  Telemetry* telemetry = nullptr;
  FlightLog* flight = nullptr;
  TickQueue* watch = nullptr;
};

/// One thread; tick() does not allocate or throw. About 80 kB: lives on the heap.
class FastProcess {
 public:
  /// All must outlive the process. The device is open.
  /// @throws InputError if the fast configuration is not valid.
  FastProcess(const FastProcessConfig& config, Device& device, RenderExchange& exchange,
              const TickOutputs& outputs);

  /// read, accept, step, write, publish. False when the run is over: fault or device
  /// lost, after which the force is zero.
  /// @param skipped deadlines that passed without a tick.
  [[nodiscard]] bool tick(std::int64_t skipped) noexcept;

  /// Another local model from the next tick on (switch_model.h).
  void use(LocalModel model) noexcept { switch_model(state_, model); }

  /// The account so far.
  [[nodiscard]] const RenderReport& report() const noexcept { return report_; }
  /// Begins with what had yielded; before the first tick. @throws as begin_yielded().
  void begin_with(const std::vector<YieldedRow>& rows) { begin_yielded(rows, state_); }
  /// What has yielded. Not in a tick.
  [[nodiscard]] std::vector<YieldedRow> yielded() const { return yielded_rows(state_); }
  /// Memory sites of the surface that have not recovered yet. Not in a tick.
  [[nodiscard]] std::vector<SurfaceDent> dents() const { return surface_dents(state_); }

 private:
  void watch(const DeviceReading& reading, DeviceStatus status,
             std::int64_t skipped) noexcept;
  [[nodiscard]] bool jumped(const DeviceReading& reading) const noexcept;
  void take_in(const Element& element) noexcept;
  [[nodiscard]] FastCommand timed_step(const DeviceReading& reading) noexcept;
  void account(const DeviceReading& reading, const FastCommand& command) noexcept;
  void account_memory(const FastCommand& command) noexcept;
  void record(const DeviceReading& reading, const FastCommand& command,
              std::uint8_t raised) noexcept;
  void publish(const DeviceReading& reading) noexcept;

  FastProcessConfig config_;
  Device& device_;
  RenderExchange& exchange_;
  TickOutputs outputs_;
  FastState state_;
  RenderReport report_;
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
