#include "tests/bench/runtime/bench_device.h"

#include <atomic>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "runtime/attach/device_choice.h"
#include "runtime/attach/driven_devices.h"
#include "runtime/bench/cylinder_body.h"
#include "runtime/emulation/emulated_falcon.h"
#include "runtime/emulation/emulated_haply.h"
#include "runtime/run/render_run.h"
#include "runtime/run/run_outcome.h"

namespace palpate {
namespace {

// A device, and the account of its motors once a run is over.
struct TracedDevice {
  AttachedDevice attached;
  std::function<std::vector<MotorRecord>()> trace;
};

TracedDevice traced_falcon(const DeviceBenchOptions& options, std::size_t commands) {
  FalconConfig driver;
  driver.firmware = emulated_firmware();
  driver.what = "emulated-falcon";
  driver.answer_s = kEmulatedAnswerS;
  driver.event_character = options.event_character;
  const auto falcon = std::make_shared<std::shared_ptr<EmulatedFalcon>>();
  return {attach(FalconLink(driver, nullptr, nullptr).limits(), falcon_centre_m(),
                 [driver, commands, falcon](const HandScript& hand) {
                   EmulatedFalconConfig config;
                   config.model.hand = hand;
                   config.model.start_m = hand.at(0.0).position_m;
                   config.model.dynamics.resolution_m = 0.0;  // the encoders' own
                   config.model.trace_max = commands;
                   *falcon = std::make_shared<EmulatedFalcon>(config);
                   return EmulatedFalcon::link(*falcon, driver);
                 }),
          [falcon] {
            return (*falcon)->model().trace();
          }};
}

TracedDevice traced_haply(std::size_t commands) {
  const auto haply = std::make_shared<std::shared_ptr<EmulatedHaply>>();
  return {attach_emulated_haply({.name = "emulated-haply"}, commands, haply.get()),
          [haply] {
            return (*haply)->model().trace();
          }};
}

TracedDevice traced_inverse3(std::size_t commands) {
  const auto board = std::make_shared<std::shared_ptr<EmulatedInverse3>>();
  return {
      attach_emulated_inverse3({.name = "emulated-inverse3"}, commands, board.get()),
      [board] {
        return (*board)->model().trace();
      }};
}

TracedDevice traced_inverse(const DeviceBenchOptions& options, std::size_t commands) {
  const auto service = std::make_shared<std::shared_ptr<EmulatedInverse>>();
  DeviceRequest request{.name = "emulated-inverse"};
  request.driver_program = options.driver_program;
  return {attach_emulated_inverse(request, {.trace_max = commands}, service.get()),
          [service] {
            return (*service)->trace();
          }};
}

TracedDevice traced_device(const DeviceBenchOptions& options) {
  const auto commands = static_cast<std::size_t>(5000.0 * (options.duration_s + 2.0));
  if (options.device == "emulated-falcon") {
    return traced_falcon(options, commands);
  }
  if (options.device == "emulated-haply") {
    return traced_haply(commands);
  }
  if (options.device == "emulated-inverse") {
    return traced_inverse(options, commands);
  }
  if (options.device == "emulated-inverse3") {
    return traced_inverse3(commands);
  }
  throw InputError(
      fmt::format("--device {}: must be emulated-falcon, emulated-haply, "
                  "emulated-inverse or emulated-inverse3",
                  options.device));
}

void check_device_bench(const DeviceBenchOptions& options) {
  if (!(options.duration_s > 0.0 && options.duration_s <= 3600.0)) {
    throw InputError(
        fmt::format("--seconds {}: must lie in (0, 3600]", options.duration_s));
  }
  if (!(options.friction >= 0.0 && options.friction <= 10.0)) {
    throw InputError(
        fmt::format("--friction {}: must lie in [0, 10]", options.friction));
  }
  if (!(options.stiffness_n_per_m > 0.0) || !std::isfinite(options.stiffness_n_per_m)) {
    throw InputError(fmt::format("--stiffness {}: must be positive and finite",
                                 options.stiffness_n_per_m));
  }
}

double milliseconds(double ns) {
  return ns / 1e6;
}

}  // namespace

DeviceBenchReport run_device_bench(const DeviceBenchOptions& options) {
  check_device_bench(options);
  CylinderBodyOptions body;
  body.stiffness_n_per_m = options.stiffness_n_per_m;
  body.friction = options.friction;
  SimulationOptions run;
  run.duration_s = options.duration_s;
  run.fast_hz = options.fast_hz;
  run.real_time = true;
  run.limit_stiffness = true;
  const TracedDevice device = traced_device(options);
  run.attached = device.attached;
  const std::atomic<bool> stop = false;
  const SimulationReport done = simulate(cylinder_body(body), run, stop);
  throw_what_ended(done);
  DeviceBenchReport report;
  report.device = options.device;
  report.wire = done.wire.value();
  report.ticks = done.render.ticks;
  report.contact_ticks = done.render.contact_ticks;
  report.missed_deadlines = done.render.missed_deadlines;
  report.force_max_n = done.render.force_max_n;
  report.model_work_j = done.render.model_work_j;
  report.stiffness_n_per_m = done.stiffness.largest_n_per_m() * done.force_scale;
  const DeviceLimits& limits = run.attached->limits;
  report.energy = wire_energy(device.trace(), report.stiffness_n_per_m,
                              report.wire.force_age.max_ns() / kNanosecondsPerSecond,
                              limits.resolution_m);
  report.absorbed_j = limits.damping_n_s_per_m * report.energy.squared_speed_m2_per_s;
  if (!(report.energy.margin_min_j >= 0.0)) {
    throw NumericalError(
        fmt::format("{}: the motors gave {:.4g} mJ more than the wire's delay "
                    "explains",
                    options.device, -report.energy.margin_min_j * 1e3));
  }
  return report;
}

std::string table_text(const DeviceBenchReport& r) {
  const LinkReport& w = r.wire;
  return fmt::format(
      "{:<20}{:.4g} s, {} transactions, {} missed, {:.5g} Hz, {} "
      "silences\n"
      "transaction         p50 {:.3f} ms, p99 {:.3f} ms, max {:.3f} ms\n"
      "age of a force      p50 {:.3f} ms, p99 {:.3f} ms, max {:.3f} ms\n"
      "fast step           {} ticks, {} missed deadlines, {} in contact, at most "
      "{:.3g} "
      "N\n"
      "ledger              {:.4g} mJ put into the model by the hand\n"
      "work of the motors  {:.4g} mJ at the end, at most {:.4g} mJ (positive: given)\n"
      "the wire's bound    {:.4g} mJ = K (A Q + 2 D L) with K {:.4g} N/m: kept\n"
      "mechanism           {:.4g} mJ absorbed by its damping\n",
      r.device, w.duration_s, w.transactions, w.missed, w.rate_hz(), w.silences,
      milliseconds(w.time.percentile_ns(0.5)), milliseconds(w.time.percentile_ns(0.99)),
      milliseconds(w.time.max_ns()), milliseconds(w.force_age.percentile_ns(0.5)),
      milliseconds(w.force_age.percentile_ns(0.99)), milliseconds(w.force_age.max_ns()),
      r.ticks, r.missed_deadlines, r.contact_ticks, r.force_max_n, r.model_work_j * 1e3,
      r.energy.given_end_j * 1e3, r.energy.given_max_j * 1e3,
      r.energy.bound_end_j * 1e3, r.stiffness_n_per_m, r.absorbed_j * 1e3);
}

std::string to_json(const DeviceBenchReport& r) {
  const LinkReport& w = r.wire;
  const nlohmann::ordered_json json = {
      {"device", r.device},
      {"duration_s", w.duration_s},
      {"transactions", w.transactions},
      {"missed", w.missed},
      {"rate_hz", w.rate_hz()},
      {"p50_ns", w.time.percentile_ns(0.5)},
      {"p99_ns", w.time.percentile_ns(0.99)},
      {"max_ns", w.time.max_ns()},
      {"force_age_p50_ns", w.force_age.percentile_ns(0.5)},
      {"force_age_p99_ns", w.force_age.percentile_ns(0.99)},
      {"force_age_max_ns", w.force_age.max_ns()},
      {"silences", w.silences},
      {"ticks", r.ticks},
      {"missed_deadlines", r.missed_deadlines},
      {"contact_ticks", r.contact_ticks},
      {"force_max_n", r.force_max_n},
      {"model_work_j", r.model_work_j},
      {"work_j", r.energy.given_end_j},
      {"work_max_j", r.energy.given_max_j},
      {"work_bound_j", r.energy.bound_end_j},
      {"absorbed_j", r.absorbed_j}};
  return json_text(json, 2);
}

}  // namespace palpate
