#include "runtime/run/reconnect.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/recording/surface_state.h"
#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

bool was_lost(const SimulationReport& report) {
  return report.render.fault == Fault::kDeviceLost ||
         report.render.fault == Fault::kDeviceSilent;
}

// Sleeps, unless stopped. False when stopped.
bool sleep(double duration_s, const std::atomic<bool>& stop) {
  constexpr std::int64_t kLookNs = 20'000'000;
  MonotonicClock clock;
  const std::int64_t until_ns = clock.now_ns() + nanoseconds_in(duration_s);
  while (!stop.load() && clock.now_ns() < until_ns) {
    clock.sleep_until_ns(std::min(until_ns, clock.now_ns() + kLookNs));
  }
  return !stop.load();
}

// The run after the device came back; nothing when stopped before that.
std::optional<SimulationReport> next_run(const ResponseDatabase& database,
                                         const SimulationOptions& options,
                                         const ReconnectOptions& reconnect,
                                         const std::atomic<bool>& stop) {
  MonotonicClock clock;
  const std::int64_t until_ns = clock.now_ns() + nanoseconds_in(reconnect.patience_s);
  while (sleep(reconnect.look_s, stop)) {
    try {
      return simulate(database, options, stop);
    } catch (const DeviceError&) {
      if (clock.now_ns() > until_ns) {
        throw;
      }
    }
  }
  return std::nullopt;
}

// run.h5 of the first run, run.2.h5 of the second.
std::filesystem::path numbered(const std::filesystem::path& file, std::size_t run) {
  if (file.empty() || run == 1) {
    return file;
  }
  return file.parent_path() /
         fmt::format("{}.{}{}", file.stem().string(), run, file.extension().string());
}

}  // namespace

std::vector<SimulationReport> simulate_and_reconnect(const ResponseDatabase& database,
                                                     const SimulationOptions& options,
                                                     const ReconnectOptions& reconnect,
                                                     const std::atomic<bool>& stop) {
  std::vector<SimulationReport> runs{simulate(database, options, stop)};
  SimulationOptions rest = options;
  while (was_lost(runs.back()) && !stop.load()) {
    // The next run has the time that is left, the same stiffness, and what has yielded.
    rest.duration_s -= runs.back().render.duration_s;
    rest.stiffness = runs.back().stiffness;
    put_surface(runs.back().render.surface, runs.back().tables, rest.surface);
    if (!(rest.duration_s > 0.0)) {
      break;
    }
    if (reconnect.tell) {
      reconnect.tell(fmt::format("{}: lost ({}); no force until it is back",
                                 runs.back().device, runs.back().device_failure));
    }
    const std::size_t run = runs.size() + 1;
    rest.recording.file = numbered(options.recording.file, run);
    rest.recording.flight_file = numbered(options.recording.flight_file, run);
    std::optional<SimulationReport> next = next_run(database, rest, reconnect, stop);
    if (!next) {
      break;
    }
    runs.push_back(std::move(*next));
  }
  return runs;
}

}  // namespace palpate
