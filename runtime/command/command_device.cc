// `palpate-run device`: renders a database on a haptic device.
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"
#include "runtime/attach/probe.h"
#include "runtime/command/commands.h"
#include "runtime/command/coupling_options.h"
#include "runtime/command/device_options.h"
#include "runtime/command/scene_options.h"
#include "runtime/realtime/stop_signals.h"
#include "runtime/run/contact_run.h"
#include "runtime/run/reconnect.h"
#include "runtime/run/render_run.h"
#include "runtime/run/run_outcome.h"

namespace palpate {
namespace {

struct Flags {
  std::string database;
  std::string model = "potential";
  bool json = false;
  bool reconnect = false;
  std::string probe_file;
  SurfaceFiles surface;
  DeviceFlags device;
  CouplingFlags coupling;
  SceneFlags scene;
  SimulationOptions options;
};

void tell_person(const std::string& text) {
  fmt::print(stderr, "{}\n", text);
}

std::vector<SimulationReport> render(const Flags& flags,
                                     const ResponseDatabase& database) {
  if (flags.reconnect) {
    return simulate_and_reconnect(
        database, flags.options,
        {.patience_s = 600.0, .look_s = 0.5, .tell = tell_person}, heed_stop_signals());
  }
  return {simulate(database, flags.options, heed_stop_signals())};
}

// One object, whose "runs" are there when a reconnection made several.
void print(const Flags& flags, const std::vector<SimulationReport>& reports) {
  if (!flags.json) {
    for (const SimulationReport& report : reports) {
      fmt::print("{}", summary(report));
    }
    return;
  }
  nlohmann::json json = as_json(reports.back());
  if (reports.size() > 1) {
    for (const SimulationReport& report : reports) {
      json["runs"].push_back(as_json(report));
    }
  }
  fmt::print("{}\n", json.dump(2));
}

// Writes what the device is like, for whoever wrote its driver.
void probe_device(Flags& flags) {
  DeviceRequest& request = flags.device.request;
  prepare_request(flags.device);
  request.sign_test = false;  // somebody would have to hold the tool
  const std::unique_ptr<DeviceLink> link = probe_link(request);
  if (!is_emulated(request.name)) {
    request.ask(fmt::format(
        "{}: let its tool stand free in the middle, where it stays by itself, and let "
        "go: it is pushed to and fro with at most 0.3 N for half a minute",
        request.name));
  }
  link->open();
  ProbeReport report;
  try {
    report = probe(*link, {}, request.stopped);
  } catch (...) {
    link->close();
    throw;
  }
  link->close();
  const std::string json = probe_json(report);
  AtomicFile file(flags.probe_file);
  file.write(std::as_bytes(std::span(json)));
  file.commit();
  fmt::print("{}", flags.json ? json : probe_text(report));
}

// A scene, while it is computed.
void run_scene(Flags& flags) {
  refuse_surface(flags.surface);
  if (flags.reconnect) {
    throw InputError("--reconnect: not of a scene, build its database first");
  }
  attach_device(flags.device, flags.options);
  const std::atomic<bool>& stop = heed_stop_signals();
  const auto client = join_scene(flags.database, flags.scene, flags.options.tool);
  const SimulationReport report = simulate_served(*client, flags.options, stop);
  print(flags, {report});
  throw_what_ended(report);
}

void run(Flags& flags) {
  if (!flags.probe_file.empty()) {
    probe_device(flags);
    return;
  }
  if (flags.database.empty()) {
    throw InputError("database: one is needed, unless a device is probed (--probe)");
  }
  flags.options.model = requested_model(flags.model);
  flags.options.coupling = wanted_coupling(flags.coupling);
  if (is_scene(flags.database)) {
    run_scene(flags);
    return;
  }
  flags.options.surface = begin_surface(flags.surface, flags.database);
  attach_device(flags.device, flags.options);
  const ResponseDatabase database = read_database(flags.database);
  if (is_contact_run(database, {flags.options.tool}, false)) {
    refuse_surface(flags.surface);
  }
  const std::vector<SimulationReport> reports = render(flags, database);
  print(flags, reports);
  leave_surface(flags.surface, flags.options.surface, std::span(&reports.back(), 1));
  throw_what_ended(reports.back());
}

}  // namespace

void add_device_command(Command app) {
  Command command =
      app.add_subcommand("device", "Render a database on a haptic device.");
  const auto flags = std::make_shared<Flags>();
  SimulationOptions& options = flags->options;
  options.fast_hz = 1000.0;
  command.add_option("database", flags->database,
                     "Response database (HDF5), or a scene (SCENE.toml) to be rendered "
                     "while it is computed");
  add_scene_options(command, flags->scene);
  add_device_options(command, flags->device);
  command.option("--device").required();
  command.add_flag("--reconnect", flags->reconnect,
                   "After an unplug wait for the device, then go on");
  command.add_option("--probe", flags->probe_file,
                     "Render nothing: find what the device is like, and write it there "
                     "(JSON)");
  command.add_option("--model", flags->model, "Local model: " + known_models())
      .show_default();
  command.add_option("--seconds", options.duration_s, "Duration [s]").show_default();
  command.add_option("--tool", options.tool, "Tool; may be left out if there is one");
  command.add_option("--fast-hz", options.fast_hz, "Rate of force updates [Hz]")
      .show_default();
  command.add_option("--slow-hz", options.slow_hz, "Rate of element updates [Hz]")
      .show_default();
  command.add_option("--force-max-n", options.force_max_n, "Largest force [N]")
      .show_default();
  command.add_flag("--limit-stiffness", options.limit_stiffness,
                   "Scale forces to what the device can render");
  add_coupling_options(command, flags->coupling);
  add_surface_options(command, flags->surface);
  command.add_flag("--json", flags->json, "Print the report for programs");
  command.callback([flags] {
    run(*flags);
  });
}

}  // namespace palpate
