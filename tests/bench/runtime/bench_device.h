// `runtime_bench device`: the whole renderer on an emulated device with the wire of the
// real one. The wire has byte times, latency timer and libusb, or driver process,
// socket and service. What the wire costs, what it keeps of the rate, and whether the
// motors give more than they may.
#pragma once

#include <cstdint>
#include <string>

#include "runtime/device/link_report.h"
#include "tests/bench/runtime/wire_energy.h"

namespace palpate {

struct DeviceBenchOptions {
  std::string device = "emulated-falcon";  ///< or -haply, -inverse, -inverse3
  double duration_s = 60.0;                ///< [s] (0, 3600]
  double fast_hz = 1000.0;                 ///< [Hz] of the fast step
  double stiffness_n_per_m = 170.0;        ///< [N/m] of the cylinder
  double friction = 0.0;         ///< [-] [0, 10]; without it nothing is dissipated
  bool event_character = false;  ///< FalconConfig's
  std::string driver_program = "/proc/self/exe";  ///< DeviceRequest's
};

struct DeviceBenchReport {
  std::string device;
  LinkReport wire;
  std::int64_t ticks = 0;
  std::int64_t contact_ticks = 0;
  std::int64_t missed_deadlines = 0;  ///< of the fast step
  double force_max_n = 0.0;
  double model_work_j = 0.0;       ///< [J] put into the local model, by the ledger
  double stiffness_n_per_m = 0.0;  ///< [N/m] largest rendered, for the bound
  WireEnergy energy;
  double absorbed_j = 0.0;  ///< [J] by the mechanism's viscous damping
};

/// A hand presses into a cylinder (cylinder_body.h), slides and lets go, again and
/// again; rendered by the potential model with ledger and safety. @throws InputError
/// for options out of range, DeviceError if the stack fails, NumericalError if the
/// motors gave more energy than the wire's delay explains (wire_energy.h).
[[nodiscard]] DeviceBenchReport run_device_bench(const DeviceBenchOptions& options);

[[nodiscard]] std::string table_text(const DeviceBenchReport& report);
[[nodiscard]] std::string to_json(const DeviceBenchReport& report);

}  // namespace palpate
