// A run that goes on after its device was unplugged and plugged in again.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "runtime/run/render_run.h"

namespace palpate {

struct ReconnectOptions {
  double patience_s = 600.0;  ///< [s] > 0 that the device may be away
  double look_s = 0.5;        ///< [s] > 0 between looks for it
  std::function<void(const std::string&)> tell;  ///< what happens; may be empty
};

/// simulate(). Where the device was lost or fell silent, waits for the device to come
/// back and renders anew for the rest of the duration. A new rendering homes where the
/// device needs that, and begins with a new ledger and the ramp from zero force.
/// Nothing drives the device in between: it is closed. The first opening is not waited
/// for. Each run has its own recording and flight log: run.h5, run.2.h5, ...
/// @returns a report for each run, in order; the last one tells how it ended.
/// @throws DeviceError if it did not come back in time, and as simulate().
[[nodiscard]] std::vector<SimulationReport> simulate_and_reconnect(
    const ResponseDatabase& database, const SimulationOptions& options,
    const ReconnectOptions& reconnect, const std::atomic<bool>& stop);

}  // namespace palpate
