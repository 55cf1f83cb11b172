// Runs the slow and the fast process against a device, in simulated or in real time.
#pragma once

#include <atomic>
#include <span>
#include <vector>

#include "runtime/device/device.h"
#include "runtime/realtime/clock.h"
#include "runtime/render/fast_process.h"
#include "runtime/render/one_contact.h"
#include "runtime/render/recorder.h"
#include "runtime/render/render_report.h"

namespace palpate {

struct RenderConfig {
  FastProcessConfig fast;
  double slow_hz = 100.0;    ///< [Hz] > 0, at most the fast rate
  double duration_s = 10.0;  ///< [s] > 0
  int cpu = -1;              ///< that the fast thread stays on in real time; -1: any
};

/// @throws InputError naming the value that is out of range.
void check(const RenderConfig& config);

/// What a run works on; all must outlive it.
struct RenderSetup {
  Device& device;                            ///< opened and closed by the run
  ElementSender* stream = nullptr;           ///< of a tool that touches at one place
  const std::atomic<bool>& stop;             ///< set: the run ends at the next tick
  std::vector<RenderTick>* trace = nullptr;  ///< filled up to its capacity
  Recorder* recorder = nullptr;              ///< records the run
  FlightLog* flight = nullptr;               ///< keeps the last ticks
  TickQueue* watch = nullptr;                ///< shows every tick
  NeedleWatch* watch_needle = nullptr;       ///< shows the needle of every tick
  FrictionWatch* watch_friction = nullptr;   ///< shows the friction of every tick
  KeptSurface surface = {};                  ///< what had stayed before
  /// Instead of the stream: tools that touch at several places ...
  RenderedBody* several = nullptr;
  Device* second = nullptr;  ///< ... and the second hand's device, opened likewise
};

/// One of several tools in a scene.
struct RenderedTool {
  RenderConfig config;
  RenderSetup setup;
};

/// Both processes take turns in the calling thread, by `clock`: with a SimulatedClock
/// the same input gives the same bits. Ends after duration_s, by `stop` or by a fault;
/// in any case with zero force. A slow process that throws ends, and
/// report.slow_failure says why. The fast process goes on with the elements that it
/// has, until its watch raises slow-stalled (in contact, after stall_fault_s). @throws
/// InputError, DeviceError (opening).
[[nodiscard]] RenderReport render_in_turns(const RenderConfig& config,
                                           const RenderSetup& setup, Clock& clock);

/// Each process in its own thread, on CLOCK_MONOTONIC: absolute deadlines, SCHED_FIFO
/// and locked memory where permitted (report.scheduling says so). Ends as above.
[[nodiscard]] RenderReport render_in_real_time(const RenderConfig& config,
                                               const RenderSetup& setup);

/// Several tools at once. Each tool has its device, its elements, and its fast process
/// with local model and ledger. The slow process is one and serves the tools in their
/// order. A tool that faults ends alone. Tools do not feel each other: every response
/// is that of the body pressed by one of them. @param tools at least one; the same
/// durations and slow rates. @returns a report each. @throws InputError, DeviceError.
[[nodiscard]] std::vector<RenderReport> render_in_turns(
    std::span<const RenderedTool> tools, Clock& clock);

/// The same with a thread for each fast process and one for the slow one.
[[nodiscard]] std::vector<RenderReport> render_in_real_time(
    std::span<const RenderedTool> tools);

}  // namespace palpate
