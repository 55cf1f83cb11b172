#include "runtime/bench_device.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/error.h"
#include "runtime/clock.h"
#include "runtime/deadlines.h"
#include "runtime/emulated_falcon.h"
#include "runtime/real_time.h"

namespace palpate {
namespace {

constexpr double kWallM = 0.12;  // z of the surface; the hand comes from above
constexpr double kTickHz = 1000.0;

EmulatedFalconConfig pressed_falcon() {
  EmulatedFalconConfig config;
  config.model.hand = {.surface_m = {0.0, 0.0, kWallM}, .normal = {0.0, 0.0, 1.0}};
  config.model.start_m = config.model.hand.at(0.0).position_m;
  config.model.dynamics.resolution_m = 0.0;  // the encoders have their own
  return config;
}

void check(const DeviceBenchOptions& options) {
  if (!(options.duration_s > 0.0 && options.duration_s <= 3600.0)) {
    throw InputError(
        fmt::format("--seconds {}: must lie in (0, 3600]", options.duration_s));
  }
  if (!(options.wall_n_per_m >= 0.0 && options.wall_n_per_m <= 1000.0)) {
    throw InputError(
        fmt::format("--wall {}: must lie in [0, 1000] N/m", options.wall_n_per_m));
  }
}

}  // namespace

DeviceBenchReport run_device_bench(const DeviceBenchOptions& options) {
  check(options);
  static_cast<void>(request_real_time(-1));
  const auto falcon = std::make_shared<EmulatedFalcon>(pressed_falcon());
  FalconConfig driver;
  driver.firmware = emulated_firmware();
  LinkedDevice device(EmulatedFalcon::link(falcon, driver), {});
  device.open();
  DeviceBenchReport report;
  MonotonicClock clock;
  const std::int64_t begin_ns = clock.now_ns();
  Deadlines deadlines(begin_ns, kTickHz);
  const double end_ns =
      static_cast<double>(begin_ns) + options.duration_s * kNanosecondsPerSecond;
  while (static_cast<double>(deadlines.next_ns()) < end_ns) {
    clock.sleep_until_ns(deadlines.next_ns());
    static_cast<void>(deadlines.begin(clock.now_ns()));
    DeviceReading reading;
    if (device.read(reading) == DeviceStatus::kLost) {
      break;
    }
    const double depth_m = std::max(0.0, kWallM - reading.position_m.z());
    const double force_n = options.wall_n_per_m * depth_m;
    static_cast<void>(device.write({0.0, 0.0, force_n}));
    report.contact_ticks += depth_m > 0.0 ? 1 : 0;
    report.force_max_n = std::max(report.force_max_n, force_n);
  }
  const std::string failure = device.failure();
  device.close();
  if (!failure.empty()) {
    throw DeviceError("emulated falcon: " + failure);
  }
  const LinkReport& link = device.report();
  report.duration_s = link.duration_s;
  report.transactions = link.transactions;
  report.missed = link.missed;
  report.rate_hz =
      static_cast<double>(link.transactions - link.missed) / link.duration_s;
  report.p50_ns = link.time.percentile_ns(0.5);
  report.p99_ns = link.time.percentile_ns(0.99);
  report.max_ns = link.time.max_ns();
  report.silences = link.silences;
  report.work_j = falcon->model().tool().rendered_work_j();
  return report;
}

std::string table_text(const DeviceBenchReport& r) {
  return fmt::format(
      "emulated falcon     {:.4g} s, {} transactions, {} missed, {:.5g} Hz\n"
      "transaction         p50 {:.0f} us, p99 {:.0f} us, max {:.0f} us\n"
      "wall                {} ticks in contact, at most {:.3g} N, {} silences\n"
      "work on the hand    {:.4g} mJ (positive: the wall gave energy)\n",
      r.duration_s, r.transactions, r.missed, r.rate_hz, r.p50_ns / 1e3, r.p99_ns / 1e3,
      r.max_ns / 1e3, r.contact_ticks, r.force_max_n, r.silences, r.work_j * 1e3);
}

std::string to_json(const DeviceBenchReport& r) {
  const nlohmann::ordered_json json = {{"duration_s", r.duration_s},
                                       {"transactions", r.transactions},
                                       {"missed", r.missed},
                                       {"rate_hz", r.rate_hz},
                                       {"p50_ns", r.p50_ns},
                                       {"p99_ns", r.p99_ns},
                                       {"max_ns", r.max_ns},
                                       {"silences", r.silences},
                                       {"contact_ticks", r.contact_ticks},
                                       {"force_max_n", r.force_max_n},
                                       {"work_j", r.work_j}};
  return json.dump(2);
}

}  // namespace palpate
