// `palpate-run bench device`: what a device's link costs and keeps, against the
// emulated Falcon with its line's byte times and latency timer.
#pragma once

#include <cstdint>
#include <string>

namespace palpate {

struct DeviceBenchOptions {
  double duration_s = 60.0;     ///< [s] (0, 3600]
  double wall_n_per_m = 200.0;  ///< [N/m] [0, 1000] that a hand presses into
};

struct DeviceBenchReport {
  double duration_s = 0.0;
  std::int64_t transactions = 0;
  std::int64_t missed = 0;  ///< no whole answer in time
  double rate_hz = 0.0;     ///< [Hz] transactions with an answer
  double p50_ns = 0.0;      ///< [ns] of a transaction
  double p99_ns = 0.0;
  double max_ns = 0.0;
  std::int64_t silences = 0;  ///< times that the link's watchdog took the force away
  std::int64_t contact_ticks = 0;
  double force_max_n = 0.0;  ///< [N] asked for
  /// [J] work of the motors on the tool, exact in the model. A force that comes a
  /// millisecond late makes it positive: the mechanism's own damping has to absorb it.
  double work_j = 0.0;
};

/// A hand presses into a wall, k times its depth, and lets go, again and again.
/// @throws InputError for options out of range, DeviceError if the stack fails.
[[nodiscard]] DeviceBenchReport run_device_bench(const DeviceBenchOptions& options);

[[nodiscard]] std::string table_text(const DeviceBenchReport& report);
[[nodiscard]] std::string to_json(const DeviceBenchReport& report);

}  // namespace palpate
