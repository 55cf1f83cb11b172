// The fast process without its clock: device in, fast step, device out, account.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "runtime/device/device.h"
#include "runtime/fast/fast_step.h"
#include "runtime/render/render_report.h"
#include "runtime/render/rendered_body.h"
#include "runtime/render/telemetry.h"
#include "runtime/render/wire_watch.h"

namespace palpate {

/// [m/s] No hand moves a tool faster.
constexpr double kHandSpeedMaxMPerS = 3.0;

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
  /// All must outlive the process. @param devices one for each of the body's hands;
  /// open before the first tick.
  FastProcess(const FastProcessConfig& config, std::span<Device* const> devices,
              RenderedBody& body, const TickOutputs& outputs)
      : config_(config), body_(body), outputs_(outputs) {
    for (Device* device : devices) {
      hand_[hands_].device = device;
      hand_[hands_++].wire = WireWatch(config.wire);
    }
  }
  FastProcess(const FastProcessConfig& config, Device& device, RenderedBody& body,
              const TickOutputs& outputs)
      : FastProcess(config, std::array<Device*, 1>{&device}, body, outputs) {}

  /// read, accept, step, write, publish. False when the run is over: fault or a device
  /// lost, after which the forces are zero.
  /// @param skipped deadlines that passed without a tick.
  [[nodiscard]] bool tick(std::int64_t skipped) noexcept;

  /// Other limits of all wires from the next tick on.
  void watch_wires(const WireLimits& limits) noexcept {
    for (Hand& hand : hand_) {
      hand.wire.limit(limits);
    }
  }

  /// The account so far.
  [[nodiscard]] const RenderReport& report() const noexcept { return report_; }

 private:
  // A hand with its device.
  struct Hand {
    Device* device = nullptr;
    WireWatch wire;
    Wrench held;                    // since its last reading
    std::int64_t silent_ticks = 0;  // reads without an answer, in a row
  };

  void read(HandReadings& reading, std::int64_t skipped) noexcept;
  void watch_hand(std::size_t hand, const DeviceReading& reading, DeviceStatus status,
                  std::int64_t skipped) noexcept;
  void watch(std::int64_t now_ns, std::int64_t skipped) noexcept;
  void tell_withheld(const HandReadings& reading) noexcept;
  [[nodiscard]] bool jumped(const DeviceReading& from,
                            const DeviceReading& to) const noexcept;
  void take_in_arrivals(std::int64_t now_ns) noexcept;
  [[nodiscard]] WrenchCommand timed_step(const HandReadings& reading) noexcept;
  void account(const HandReadings& reading, const WrenchCommand& command) noexcept;
  void account_hand(std::size_t hand, const DeviceReading& reading,
                    const WrenchCommand& command) noexcept;
  void trace(const HandReadings& reading, const WrenchCommand& command) noexcept;
  void record(const HandReadings& reading, const WrenchCommand& command,
              std::uint8_t raised) noexcept;

  FastProcessConfig config_;
  std::array<Hand, kPortsMax> hand_;
  std::size_t hands_ = 0;
  RenderedBody& body_;
  TickOutputs outputs_;
  RenderReport report_;
  HandReadings last_;
  std::int64_t first_ns_ = 0;
  std::int64_t element_ns_ = 0;  // when the latest element was taken in
  bool stalled_ = false;
  bool withheld_ = false;  // the driver could not render a force whole
  std::int64_t arrivals_ = 0;
  std::uint8_t flags_ = 0;  // TickFlag bits known before the step
};

}  // namespace palpate
