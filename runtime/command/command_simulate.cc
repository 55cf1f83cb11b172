#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/forms/open_stored.h"
#include "formats/recording/recording.h"
#include "runtime/command/commands.h"
#include "runtime/command/coupling_options.h"
#include "runtime/command/device_options.h"
#include "runtime/command/scene_options.h"
#include "runtime/realtime/stop_signals.h"
#include "runtime/run/render_run.h"
#include "runtime/run/run_outcome.h"
#include "runtime/run/surface_file.h"

namespace palpate {
namespace {

struct SimulateFlags {
  std::string database;
  std::string model = "potential";
  std::string clock = "simulated";
  std::string stream = "auto";
  double stream_budget_mib = 48.0;
  std::vector<std::string> tools;
  std::vector<double> at_m;
  std::vector<std::string> records;
  std::vector<std::string> flight_recorders;
  std::vector<std::string> devices;
  bool json = false;
  bool together = false;
  CouplingFlags coupling;
  SurfaceFiles surface;
  SceneFlags scene;
  std::string quality_csv;
  double wander_mm_per_s = 0.0;
  SimulationOptions options;
};

SimulationOptions options_of(const SimulateFlags& flags) {
  SimulationOptions options = flags.options;
  if (flags.clock != "simulated" && flags.clock != "real") {
    throw InputError(fmt::format("--clock {}: must be simulated or real", flags.clock));
  }
  options.model = requested_model(flags.model);
  options.coupling = wanted_coupling(flags.coupling);
  options.real_time = flags.clock == "real" || is_scene(flags.database);
  options.wander_m_per_s = 1e-3 * flags.wander_mm_per_s;
  return options;
}

// Where the tool of that number presses; none: anywhere.
std::optional<Eigen::Vector3d> place(const SimulateFlags& flags, std::size_t tool) {
  if (flags.at_m.empty()) {
    return std::nullopt;
  }
  const Eigen::Vector3d at_m = Eigen::Map<const Eigen::Vector3d>(&flags.at_m[3 * tool]);
  if (!at_m.allFinite()) {
    throw InputError("--at: coordinates must be finite");
  }
  return at_m;
}

// What a flag says of the tool of that number; "" where it is not given.
// @throws InputError unless it is given for every tool or for none.
std::string said_of(std::size_t tool, std::size_t tools, const char* flag,
                    const std::vector<std::string>& values) {
  if (!values.empty() && values.size() != tools) {
    throw InputError(fmt::format(
        "{} is given {} times, must be given once for each of "
        "{} tools{}",
        flag, values.size(), tools, tools == 1 ? ", or for two together" : ""));
  }
  return values.empty() ? "" : values[tool];
}

void check_places(const SimulateFlags& flags) {
  const std::size_t tools = std::max<std::size_t>(1, flags.tools.size());
  if (!flags.at_m.empty() && flags.at_m.size() != 3 * tools) {
    throw InputError(
        fmt::format("--at has {} coordinates, must have three for each of "
                    "{} tools",
                    flags.at_m.size(), tools));
  }
}

// The options of each tool that is rendered by itself; of two together there is one.
std::vector<SimulationOptions> tools_of(const SimulateFlags& flags) {
  const std::size_t tools = std::max<std::size_t>(1, flags.tools.size());
  check_places(flags);
  if (flags.together && tools != 2) {
    throw InputError(fmt::format(
        "--together is of two tools, must be two as --tool a,b; got {}", tools));
  }
  const std::size_t runs = flags.together ? 1 : tools;
  const bool recorded = !flags.records.empty() || !flags.flight_recorders.empty();
  const RecordingRequest recording{
      .database = std::filesystem::path(flags.database).filename(),
      .database_sha256 = recorded ? database_sha256(flags.database) : ""};
  std::vector<SimulationOptions> options(runs, options_of(flags));
  for (std::size_t i = 0; i < runs; ++i) {
    options[i].tool = flags.tools.empty() ? "" : flags.tools[i];
    options[i].at_m = place(flags, i);
    options[i].socket = said_of(i, tools, "--device", flags.devices);
    options[i].recording = recording;
    options[i].recording.file = said_of(i, runs, "--record", flags.records);
    options[i].recording.flight_file =
        said_of(i, runs, "--flight-recorder", flags.flight_recorders);
  }
  if (flags.together) {
    options[0].together =
        SecondHand{.tool = flags.tools[1],
                   .at_m = place(flags, 1),
                   .socket = said_of(1, tools, "--device", flags.devices)};
  }
  return options;
}

// Larger files are streamed: as values in memory they are larger still.
constexpr std::uintmax_t kStreamFrom = std::uintmax_t{256} << 20;

bool is_streamed(const SimulateFlags& flags) {
  if (flags.stream != "auto" && flags.stream != "on" && flags.stream != "off") {
    throw InputError(fmt::format("--stream {}: must be auto, on or off", flags.stream));
  }
  if (!(flags.stream_budget_mib > 0.0 && flags.stream_budget_mib < 1e6)) {
    throw InputError(fmt::format("--stream-budget-mib {}: must lie in (0, 1e6) MiB",
                                 flags.stream_budget_mib));
  }
  std::error_code missing;  // said by who opens it
  const std::uintmax_t bytes = std::filesystem::file_size(flags.database, missing);
  return flags.stream == "on" ||
         (flags.stream == "auto" && !missing && bytes > kStreamFrom);
}

std::vector<SimulationOptions> tools_on(const SimulateFlags& flags,
                                        const SurfaceState& surface) {
  std::vector<SimulationOptions> tools = tools_of(flags);
  for (SimulationOptions& tool : tools) {
    tool.surface = surface;
  }
  return tools;
}

std::vector<SimulationReport> render_streamed(const SimulateFlags& flags,
                                              const SurfaceState& surface) {
  const auto budget = static_cast<std::size_t>(flags.stream_budget_mib *
                                               static_cast<double>(kMebibyte));
  return simulate_streamed(flags.database, tools_on(flags, surface), budget,
                           stop_signals());
}

void print_tools(const SimulateFlags& flags,
                 const std::vector<SimulationReport>& reports) {
  if (flags.json && reports.size() == 1) {
    fmt::print("{}\n", json_text(as_json(reports.front()), 2));
  } else if (flags.json) {
    nlohmann::json all = nlohmann::json::array();
    for (const SimulationReport& report : reports) {
      all.push_back(as_json(report));
    }
    fmt::print("{}\n", json_text(nlohmann::json{{"tools", all}}, 2));
  } else {
    for (std::size_t i = 0; i < reports.size(); ++i) {
      fmt::print("{}{}", i == 0 ? "" : "\n", summary(reports[i]));
    }
  }
}

// A scene, while it is computed.
void simulate_scene(const SimulateFlags& flags) {
  refuse_surface(flags.surface);
  if (flags.together || flags.tools.size() > 1 || !flags.records.empty() ||
      !flags.flight_recorders.empty()) {
    throw InputError(
        "a scene is rendered with one tool, and not recorded: leave out --together, "
        "--record and --flight-recorder, or build its database first");
  }
  const SimulationOptions options = tools_of(flags).front();
  const std::atomic<bool>& stop = stop_signals();
  const auto client = join_scene(flags.database, flags.scene, options.tool);
  const SimulationReport report = simulate_served(*client, options, stop);
  print_tools(flags, {report});
  if (!flags.quality_csv.empty()) {
    const std::string text = quality_csv(*report.served);
    AtomicFile file(flags.quality_csv);
    file.write(std::as_bytes(std::span(text)));
    file.commit();
  }
  throw_what_ended(report);
}

void run_simulation(const SimulateFlags& flags) {
  if (is_scene(flags.database)) {
    simulate_scene(flags);
    return;
  }
  refuse_scene_options(flags.scene);
  if (!flags.quality_csv.empty()) {
    throw InputError("--quality-csv is of a scene that is computed meanwhile");
  }
  const SurfaceState surface = begin_surface(flags.surface, flags.database);
  std::vector<SimulationReport> reports;
  if (is_streamed(flags)) {
    reports = render_streamed(flags, surface);
  } else {
    const ResponseDatabase database = read_database(flags.database);
    reports = simulate(database, tools_on(flags, surface), stop_signals());
  }
  print_tools(flags, reports);
  leave_surface(flags.surface, surface, reports);
  for (const SimulationReport& report : reports) {
    throw_what_ended(report);
  }
}

void add_contact_options(Command command, SimulateFlags& flags) {
  command.add_flag("--together", flags.together,
                   "Two tools press one body together, coupled through it (a pinch)");
  command.add_option("--trace", flags.options.trace,
                     "Poses, forces and torques of every tick "
                     "(comma-separated values)");
  command.add_option("--poses", flags.options.poses, "Replay the poses of such a file");
  add_coupling_options(command, flags.coupling);
  command
      .add_option("--tilt-rad", flags.options.tilt_rad,
                  "Of several contacts: how far the hand rocks its tool [rad]")
      .show_default();
  command
      .add_option("--turn-rad", flags.options.turn_rad,
                  "Of several contacts: how far it turns it about the normal [rad]")
      .show_default();
}

void add_each_tools_files(Command command, SimulateFlags& flags) {
  const auto add_each = [&](const char* flag, std::vector<std::string>& values,
                            const char* what) {
    command.add_option(flag, values, what).one_value_each();
  };
  add_each("--record", flags.records,
           "Record every tick into this file, for replay; once for each tool");
  add_each("--flight-recorder", flags.flight_recorders,
           "On a fault, write the last seconds into this file; once for each tool");
  add_each("--device", flags.devices,
           "Socket of a device's driver instead of the simulated device "
           "(runtime/device/socket_device.h); once for each tool");
}

void add_wander_options(Command command, SimulateFlags& flags) {
  command
      .add_option("--wander-mm-per-s", flags.wander_mm_per_s,
                  "The hand wanders over the body at this speed [mm/s], pressing; 0: "
                  "it presses one place")
      .show_default()
      .in_range(0.0, 1000.0);
  command.add_option("--quality-csv", flags.quality_csv,
                     "Of a scene: shares of the ticks in the body without an answer, "
                     "with a preliminary and with a final one, by second");
  add_scene_options(command, flags.scene);
}

}  // namespace

void add_simulate_command(Command app) {
  Command command = app.add_subcommand(
      "simulate", "Render a database on a simulated device held by a simulated hand.");
  const auto flags = std::make_shared<SimulateFlags>();
  SimulationOptions& options = flags->options;
  command
      .add_option(
          "database", flags->database,
          "Response database (HDF5 or flat), or a scene (SCENE.toml) to be rendered in "
          "real time while it is computed")
      .required();
  command.add_option("--model", flags->model, "Local model: " + known_models())
      .show_default();
  command.add_option("--seconds", options.duration_s, "Duration [s]").show_default();
  command
      .add_option("--tool", flags->tools,
                  "Tool, or several at once: a,b; may be left out if there is one")
      .separated_by(',')
      .one_value_each();
  command.add_option("--slow-hz", options.slow_hz, "Rate of element updates [Hz]")
      .show_default();
  command.add_option("--fast-hz", options.fast_hz, "Rate of force updates [Hz]")
      .show_default();
  command
      .add_option("--at", flags->at_m,
                  "Where to press: x,y,z [m], for each tool in turn")
      .separated_by(',')
      .one_value_each();
  command.add_option("--clock", flags->clock, "simulated (repeatable, fast) or real")
      .show_default();
  command.add_option("--force-max-n", options.force_max_n, "Largest force [N]")
      .show_default();
  command.add_flag("--limit-stiffness", options.limit_stiffness,
                   "Scale forces to what the device can render");
  command
      .add_option("--stream", flags->stream,
                  "Leave the responses in the file: auto (above 256 MiB), on or off")
      .show_default();
  command
      .add_option("--stream-budget-mib", flags->stream_budget_mib,
                  "Memory for streamed responses [MiB]")
      .show_default();
  add_each_tools_files(command, *flags);
  command
      .add_option("--ramp-s", options.ramp_s,
                  "Time from the start until the largest force is allowed [s]")
      .show_default();
  command.add_option("--cpu", options.cpu,
                     "Keep the fast thread on this CPU (--clock real)");
  add_wander_options(command, *flags);
  add_contact_options(command, *flags);
  add_surface_options(command, flags->surface);
  command.add_flag("--json", flags->json, "Print the report for programs");
  command.callback([flags] {
    run_simulation(*flags);
  });
}

}  // namespace palpate
