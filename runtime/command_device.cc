#include "runtime/command_device.h"

#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/error.h"
#include "runtime/simulation.h"
#include "runtime/simulation_outcome.h"
#include "runtime/stop_signals.h"

namespace palpate {
namespace {

struct Flags {
  std::string database;
  std::string model = "potential";
  bool json = false;
  DeviceRequest device;
  SimulationOptions options;
};

void run(Flags& flags) {
  flags.device.tell = [](const std::string& text) {
    fmt::print(stderr, "{}\n", text);
  };
  flags.options.model = requested_model(flags.model);
  flags.options.real_time = true;
  flags.options.attached = choose_device(flags.device);
  const ResponseDatabase database = read_database(flags.database);
  const SimulationReport report =
      simulate(database, flags.options, heed_stop_signals());
  fmt::print("{}", flags.json ? as_json(report).dump(2) + "\n" : summary(report));
  throw_what_ended(report);
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
