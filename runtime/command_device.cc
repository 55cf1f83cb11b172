#include "runtime/command_device.h"

#include <atomic>
#include <csignal>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/error.h"
#include "runtime/simulation.h"

namespace palpate {
namespace {

std::atomic<bool> device_stop_requested = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

extern "C" void request_device_stop(int /*signal*/) {
  device_stop_requested.store(true);
}

struct Flags {
  std::string database;
  std::string model = "potential";
  bool json = false;
  DeviceRequest device;
  SimulationOptions options;
};

nlohmann::json as_json(const SimulationReport& report) {
  const RenderReport& r = report.render;
  return {{"device", report.device},
          {"device_failure", report.device_failure},
          {"tool", report.tool},
          {"node", report.node},
          {"force_scale", report.force_scale},
          {"renderable_n_per_m", report.bounds.renderable_n_per_m()},
          {"duration_s", r.duration_s},
          {"ticks", r.ticks},
          {"contact_ticks", r.contact_ticks},
          {"late_reads", r.late_reads},
          {"missed_deadlines", r.missed_deadlines},
          {"depth_max_m", r.depth_max_m},
          {"force_max_n", r.force_max_n},
          {"net_energy_j", r.net_energy_j()},
          {"model_work_j", r.model_work_j},
          {"step_p50_ns", r.step_time.percentile_ns(0.5)},
          {"step_p99_ns", r.step_time.percentile_ns(0.99)},
          {"scheduling", r.scheduling},
          {"fault", name(r.fault)},
          {"interrupted", r.interrupted}};
}

void report_end(const SimulationReport& report) {
  const RenderReport& r = report.render;
  if (r.fault == Fault::kDeviceLost || r.fault == Fault::kDeviceSilent) {
    throw DeviceError(fmt::format(
        "{}: fault \"{}\" after {:.4g} s{}{}", report.device, name(r.fault), r.fault_s,
        report.device_failure.empty() ? "" : ": ", report.device_failure));
  }
  if (r.fault != Fault::kNone) {
    throw NumericalError(fmt::format("stopped by fault \"{}\" after {:.4g} s",
                                     name(r.fault), r.fault_s));
  }
  if (r.slow_error != nullptr) {
    std::rethrow_exception(r.slow_error);
  }
  if (r.interrupted) {
    throw Interrupted();
  }
}

void run(Flags& flags) {
  flags.device.tell = [](const std::string& text) {
    fmt::print(stderr, "{}\n", text);
  };
  flags.options.model = requested_model(flags.model);
  flags.options.real_time = true;
  flags.options.attached = choose_device(flags.device);
  const ResponseDatabase database = read_database(flags.database);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    std::signal(signal, request_device_stop);
  }
  const SimulationReport report =
      simulate(database, flags.options, device_stop_requested);
  fmt::print("{}", flags.json ? as_json(report).dump(2) + "\n" : summary(report));
  report_end(report);
}

}  // namespace

void add_device_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("device", "Render a database on a haptic device.");
  const auto flags = std::make_shared<Flags>();
  SimulationOptions& options = flags->options;
  options.fast_hz = 1000.0;
  command->add_option("database", flags->database, "Response database (HDF5)")
      ->required();
  command->add_option("--device", flags->device.name, "One of: " + known_device_names())
      ->required();
  command->add_option("--firmware", flags->device.firmware,
                      "The vendor's firmware image, for a falcon that has none yet");
  command->add_option("--usb", flags->device.usb, "BUS:ADDRESS, where two are alike");
  command
      ->add_option("--calibration", flags->device.calibration,
                   "Factor on motor commands [-]")
      ->capture_default_str();
  command
      ->add_option("--homing-s", flags->device.homing_s, "Time to home the device [s]")
      ->capture_default_str();
  command->add_option("--model", flags->model, "Local model: " + known_models())
      ->capture_default_str();
  command->add_option("--seconds", options.duration_s, "Duration [s]")
      ->capture_default_str();
  command->add_option("--tool", options.tool, "Tool; may be left out if there is one");
  command->add_option("--fast-hz", options.fast_hz, "Rate of force updates [Hz]")
      ->capture_default_str();
  command->add_option("--slow-hz", options.slow_hz, "Rate of element updates [Hz]")
      ->capture_default_str();
  command->add_option("--force-max-n", options.force_max_n, "Largest force [N]")
      ->capture_default_str();
  command->add_flag("--limit-stiffness", options.limit_stiffness,
                    "Scale forces to what the device can render");
  command->add_flag("--json", flags->json, "Print the report for programs");
  command->callback([flags] {
    run(*flags);
  });
}

}  // namespace palpate
