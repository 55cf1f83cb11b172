// `palpate-run device`: renders a database on a haptic device.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/forms/open_stored.h"
#include "formats/recording/recording.h"
#include "runtime/attach/probe_file.h"
#include "runtime/command/commands.h"
#include "runtime/command/coupling_options.h"
#include "runtime/command/device_options.h"
#include "runtime/command/scene_options.h"
#include "runtime/command/terminal_guide.h"
#include "runtime/realtime/real_time.h"
#include "runtime/realtime/stop_signals.h"
#include "runtime/run/reconnect.h"
#include "runtime/run/render_run.h"
#include "runtime/run/run_outcome.h"

namespace palpate {
namespace {

struct DeviceRunFlags {
  std::string database;
  std::string model = "potential";
  bool json = false;
  bool reconnect = false;
  std::string probe_file;
  std::string probe_axes = "xyz";
  SurfaceFiles surface;
  DeviceFlags device;
  CouplingFlags coupling;
  SceneFlags scene;
  SimulationOptions options;
};

std::vector<SimulationReport> render(const DeviceRunFlags& flags,
                                     const ResponseDatabase& database) {
  if (flags.reconnect) {
    return simulate_and_reconnect(
        database, flags.options,
        {.patience_s = 600.0, .look_s = 0.5, .tell = tell_person}, stop_signals());
  }
  return {simulate(database, flags.options, stop_signals())};
}

// One object, whose "runs" are there when a reconnection made several.
void print_runs(const DeviceRunFlags& flags,
                const std::vector<SimulationReport>& reports) {
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
  fmt::print("{}\n", json_text(json, 2));
}

ProbeOptions probe_options(const DeviceRunFlags& flags) {
  ProbeOptions options;
  options.by_hand = !is_emulated(flags.device.request.name);
  options.planar = moves_in_a_plane(flags.device.request.name);
  options.axes.clear();
  for (const char axis : flags.probe_axes) {
    const int number = axis - 'x';
    if (number < 0 || number > 2 ||
        std::count(options.axes.begin(), options.axes.end(), number) > 0) {
      throw InputError(
          fmt::format("--probe-axes {}: must be some of x, y and z, each once, as xz",
                      flags.probe_axes));
    }
    if (number < 2 || !options.planar) {
      options.axes.push_back(number);
    }
  }
  if (options.axes.empty()) {
    throw InputError(fmt::format("--probe-axes {}: none that a {} moves along",
                                 flags.probe_axes, flags.device.request.name));
  }
  return options;
}

// Writes what the device is like, for whoever wrote its driver.
void probe_device(DeviceRunFlags& flags) {
  DeviceRequest& request = flags.device.request;
  prepare_request(flags.device);
  request.sign_test = false;  // somebody would have to hold the tool
  const ProbeOptions options = probe_options(flags);
  const std::unique_ptr<DeviceLink> link = probe_link(request);
  link->open();
  fmt::print(stderr, "{}: probed for about {:.0f} s, with at most {} N\n", request.name,
             probe_duration_s(options), options.force_n);
  ProbeReport report;
  try {
    TerminalGuide terminal;
    MonotonicClock clock;
    static_cast<void>(request_real_time(-1));  // as a driver's thread has, if permitted
    report = probe(*link, options, terminal.guide(), clock);
  } catch (...) {
    link->close();
    tell_person(fmt::format("{}: let go; nothing was written", request.name));
    throw;
  }
  link->close();
  write_probe(flags.probe_file, report);
  fmt::print("{}", flags.json ? probe_json(report) : probe_text(report));
  fmt::print(stderr, "written to {}: send it, or render by it (--probed)\n",
             flags.probe_file);
}

// A scene, while it is computed.
void run_scene_on_device(DeviceRunFlags& flags) {
  refuse_surface(flags.surface);
  if (flags.reconnect || !flags.options.recording.file.empty() ||
      !flags.options.recording.flight_file.empty()) {
    throw InputError(
        "--reconnect, --record and --flight-recorder: not of a scene, build its "
        "database first");
  }
  refuse_together_of_scene(flags.device);
  attach_device(flags.device, flags.options);
  const std::atomic<bool>& stop = stop_signals();
  const auto client = join_scene(flags.database, flags.scene, flags.options.tool);
  const SimulationReport report = simulate_served(*client, flags.options, stop);
  print_runs(flags, {report});
  throw_what_ended(report);
}

// What a recording says of its database.
void name_recorded(DeviceRunFlags& flags) {
  RecordingRequest& recording = flags.options.recording;
  if (recording.file.empty() && recording.flight_file.empty()) {
    return;
  }
  recording.database = std::filesystem::path(flags.database).filename();
  recording.database_sha256 = database_sha256(flags.database);
}

void run_device(DeviceRunFlags& flags) {
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
    run_scene_on_device(flags);
    return;
  }
  refuse_scene_options(flags.scene);
  name_recorded(flags);
  flags.options.surface = begin_surface(flags.surface, flags.database);
  const ResponseDatabase database = read_database(flags.database);
  check_tools(flags.device);
  attach_device(flags.device, flags.options);
  const std::vector<SimulationReport> reports = render(flags, database);
  print_runs(flags, reports);
  leave_surface(flags.surface, flags.options.surface, std::span(&reports.back(), 1));
  throw_what_ended(reports.back());
}

}  // namespace

void add_device_command(Command app) {
  Command command =
      app.add_subcommand("device", "Render a database on a haptic device.");
  const auto flags = std::make_shared<DeviceRunFlags>();
  SimulationOptions& options = flags->options;
  options.fast_hz = 1000.0;
  command.add_option(
      "database", flags->database,
      "Response database (HDF5 or flat), or a scene (SCENE.toml) to be rendered "
      "while it is computed");
  add_scene_options(command, flags->scene);
  add_device_options(command, flags->device);
  command.option("--device").required();
  command.add_flag("--reconnect", flags->reconnect,
                   "After an unplug wait for the device, then go on");
  command.add_option("--probe", flags->probe_file,
                     "Render nothing: find what the device is like, and write it there "
                     "(JSON)");
  command
      .add_option("--probe-axes", flags->probe_axes,
                  "Axes of the device to push along: x right, y up, z towards you")
      .show_default();
  command.add_option("--model", flags->model, "Local model: " + known_models())
      .show_default();
  command.add_option("--seconds", options.duration_s, "Duration [s]").show_default();
  add_tool_options(command, flags->device);
  command.add_option("--fast-hz", options.fast_hz, "Rate of force updates [Hz]")
      .show_default();
  command.add_option("--slow-hz", options.slow_hz, "Rate of element updates [Hz]")
      .show_default();
  command.add_option("--force-max-n", options.force_max_n, "Largest force [N]")
      .show_default();
  command.add_flag("--limit-stiffness", options.limit_stiffness,
                   "Scale forces to what the device can render");
  command.add_option(
      "--record", options.recording.file,
      "Record every tick into this file, for replay; after a reconnection "
      "into FILE.2.h5 and so on");
  command.add_option("--flight-recorder", options.recording.flight_file,
                     "On a fault, write the last seconds into this file");
  add_coupling_options(command, flags->coupling);
  add_surface_options(command, flags->surface);
  command.add_flag("--json", flags->json, "Print the report for programs");
  command.callback([flags] {
    run_device(*flags);
  });
}

}  // namespace palpate
