#include "runtime/command_simulate.h"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/error.h"
#include "formats/recording.h"
#include "runtime/simulation.h"

namespace palpate {
namespace {

std::atomic<bool> stop_requested = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

extern "C" void request_stop(int /*signal*/) {
  stop_requested.store(true);
}

struct Flags {
  std::string database;
  std::string model = "potential";
  std::string clock = "simulated";
  std::string stream = "auto";
  double stream_budget_mib = 48.0;
  std::vector<std::string> tools;
  std::vector<double> at_m;
  std::string record;
  std::string flight_recorder;
  std::string device;
  bool json = false;
  SimulationOptions options;
};

SimulationOptions options_of(const Flags& flags) {
  SimulationOptions options = flags.options;
  options.recording = {.file = flags.record,
                       .flight_file = flags.flight_recorder,
                       .database = std::filesystem::path(flags.database).filename(),
                       .database_sha256 = {}};
  options.socket = flags.device;
  if (flags.clock != "simulated" && flags.clock != "real") {
    throw InputError(fmt::format("--clock {}: must be simulated or real", flags.clock));
  }
  options.model = requested_model(flags.model);
  options.real_time = flags.clock == "real";
  return options;
}

// Where the tool of that number presses; none: anywhere.
std::optional<Eigen::Vector3d> place(const Flags& flags, std::size_t tool) {
  if (flags.at_m.empty()) {
    return std::nullopt;
  }
  const Eigen::Vector3d at_m = Eigen::Map<const Eigen::Vector3d>(&flags.at_m[3 * tool]);
  if (!at_m.allFinite()) {
    throw InputError("--at: coordinates must be finite");
  }
  return at_m;
}

// The options of each tool.
std::vector<SimulationOptions> tools_of(const Flags& flags) {
  const std::size_t tools = std::max<std::size_t>(1, flags.tools.size());
  if (!flags.at_m.empty() && flags.at_m.size() != 3 * tools) {
    throw InputError(
        fmt::format("--at has {} coordinates, must have three for each of "
                    "{} tools",
                    flags.at_m.size(), tools));
  }
  if (tools > 1 && (!flags.record.empty() || !flags.flight_recorder.empty() ||
                    !flags.device.empty())) {
    throw InputError(fmt::format(
        "--tool names {} tools; --record, --flight-recorder and --device are for one",
        tools));
  }
  std::vector<SimulationOptions> options(tools, options_of(flags));
  for (std::size_t i = 0; i < tools; ++i) {
    options[i].tool = flags.tools.empty() ? "" : flags.tools[i];
    options[i].at_m = place(flags, i);
  }
  return options;
}

nlohmann::json as_json(const StreamReport& stream) {
  return {{"updates", stream.updates},
          {"starved", stream.starved},
          {"chunks_loaded", stream.cache.loaded},
          {"chunks_evicted", stream.cache.evicted},
          {"chunks_wanted", stream.cache.wanted},
          {"chunks_hit", stream.cache.hits},
          {"bytes_max", stream.cache.bytes_max},
          {"fault", stream.fault}};
}

nlohmann::json as_json(const SimulationReport& report) {
  const RenderReport& r = report.render;
  return {{"model", name(report.options.model)},
          {"tool", report.tool},
          {"node", report.node},
          {"fast_hz", report.options.fast_hz},
          {"slow_hz", report.options.slow_hz},
          {"real_time", report.options.real_time},
          {"stiffness_max_n_per_m", report.stiffness.normal_n_per_m},
          {"friction_stiffness_n_per_m", report.stiffness.friction_n_per_m},
          {"passivity_bound_n_per_m", report.bounds.passivity_n_per_m},
          {"sampling_bound_n_per_m", report.bounds.sampling_n_per_m},
          {"delay_bound_n_per_m", report.bounds.delay_n_per_m},
          {"quantisation_bound_n_per_m", report.bounds.quantisation_n_per_m},
          {"renderable_n_per_m", report.bounds.renderable_n_per_m()},
          {"force_scale", report.force_scale},
          {"duration_s", r.duration_s},
          {"ticks", r.ticks},
          {"contact_ticks", r.contact_ticks},
          {"starved_ticks", r.starved_ticks},
          {"extrapolated_ticks", r.extrapolated_ticks},
          {"missed_deadlines", r.missed_deadlines},
          {"slow_updates", r.slow_updates},
          {"slow_missed_deadlines", r.slow_missed_deadlines},
          {"slow_stalls", r.slow_stalls},
          {"elements_dropped", r.elements_dropped},
          {"depth_max_m", r.depth_max_m},
          {"force_max_n", r.force_max_n},
          {"energy_in_j", r.energy_in_j},
          {"energy_out_j", r.energy_out_j},
          {"net_energy_j", r.net_energy_j()},
          {"model_work_j", r.model_work_j},
          {"stored_j", r.stored_j},
          {"dissipated_j", r.dissipated_j},
          {"tank_j", r.tank_j},
          {"tank_max_j", r.tank_max_j},
          {"relaxed_shift_max_m", r.relaxed_shift_max_m},
          {"step_p50_ns", r.step_time.percentile_ns(0.5)},
          {"step_p99_ns", r.step_time.percentile_ns(0.99)},
          {"step_p999_ns", r.step_time.percentile_ns(0.999)},
          {"step_max_ns", r.step_time.max_ns()},
          {"late_reads", r.late_reads},
          {"slow_failure", r.slow_failure},
          {"scheduling", r.scheduling},
          {"device", report.device},
          {"records_dropped", report.records_dropped},
          {"recording_failure", report.recording_failure},
          {"stream", report.stream ? as_json(*report.stream) : nlohmann::json()},
          {"fault", name(r.fault)},
          {"interrupted", r.interrupted}};
}

// Larger files are streamed: as values in memory they are larger still.
constexpr std::uintmax_t kStreamFrom = std::uintmax_t{256} << 20;

bool is_streamed(const Flags& flags) {
  if (flags.stream != "auto" && flags.stream != "on" && flags.stream != "off") {
    throw InputError(fmt::format("--stream {}: must be auto, on or off", flags.stream));
  }
  if (!(flags.stream_budget_mib > 0.0 && flags.stream_budget_mib < 1e6)) {
    throw InputError(fmt::format("--stream-budget {}: must lie in (0, 1e6) MiB",
                                 flags.stream_budget_mib));
  }
  std::error_code missing;  // said by who opens it
  const std::uintmax_t bytes = std::filesystem::file_size(flags.database, missing);
  return flags.stream == "on" ||
         (flags.stream == "auto" && !missing && bytes > kStreamFrom);
}

void heed_signals() {
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
  std::signal(SIGHUP, request_stop);
}

std::vector<SimulationReport> render(const Flags& flags) {
  std::vector<SimulationOptions> tools = tools_of(flags);
  if (!flags.record.empty() || !flags.flight_recorder.empty()) {
    tools.front().recording.database_sha256 = database_sha256(flags.database);
  }
  if (is_streamed(flags)) {
    if (tools.size() > 1) {
      throw InputError(fmt::format(
          "--tool names {} tools, responses can be streamed for one; --stream off "
          "keeps them in memory",
          tools.size()));
    }
    const auto budget = static_cast<std::size_t>(flags.stream_budget_mib *
                                                 static_cast<double>(kMebibyte));
    heed_signals();
    return {simulate_streamed(flags.database, tools.front(), budget, stop_requested)};
  }
  const ResponseDatabase database = read_database(flags.database);
  heed_signals();
  return simulate(database, tools, stop_requested);
}

void print(const Flags& flags, const std::vector<SimulationReport>& reports) {
  if (flags.json && reports.size() == 1) {
    fmt::print("{}\n", as_json(reports.front()).dump(2));
  } else if (flags.json) {
    nlohmann::json all = nlohmann::json::array();
    for (const SimulationReport& report : reports) {
      all.push_back(as_json(report));
    }
    fmt::print("{}\n", nlohmann::json{{"tools", all}}.dump(2));
  } else {
    for (std::size_t i = 0; i < reports.size(); ++i) {
      fmt::print("{}{}", i == 0 ? "" : "\n", summary(reports[i]));
    }
  }
}

// What of a report ends the tool with an error.
void complain(const SimulationReport& report) {
  if (report.render.fault != Fault::kNone) {
    const std::string what =
        fmt::format("stopped by fault \"{}\" after {:.4g} s", name(report.render.fault),
                    report.render.fault_s);
    if (report.render.fault == Fault::kDeviceLost) {
      throw DeviceError(what);
    }
    throw NumericalError(what);
  }
  if (report.stream && !report.stream->fault.empty()) {
    throw FormatError(report.stream->fault);
  }
  if (report.render.slow_error != nullptr) {
    std::rethrow_exception(report.render.slow_error);
  }
  if (!report.recording_failure.empty()) {
    throw InputError(report.recording_failure);
  }
  if (report.render.interrupted) {
    throw Interrupted();
  }
}

void run(const Flags& flags) {
  const std::vector<SimulationReport> reports = render(flags);
  print(flags, reports);
  for (const SimulationReport& report : reports) {
    complain(report);
  }
}

}  // namespace

void add_simulate_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "simulate", "Render a database on a simulated device held by a simulated hand.");
  const auto flags = std::make_shared<Flags>();
  SimulationOptions& options = flags->options;
  command->add_option("database", flags->database, "Response database (HDF5)")
      ->required();
  command->add_option("--model", flags->model, "Local model: " + known_models())
      ->capture_default_str();
  command->add_option("--seconds", options.duration_s, "Duration [s]")
      ->capture_default_str();
  command
      ->add_option("--tool", flags->tools,
                   "Tool, or several at once: a,b; may be left out if there is one")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--slow-hz", options.slow_hz, "Rate of element updates [Hz]")
      ->capture_default_str();
  command->add_option("--fast-hz", options.fast_hz, "Rate of force updates [Hz]")
      ->capture_default_str();
  command
      ->add_option("--at", flags->at_m,
                   "Where to press: x,y,z [m], for each tool in turn")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--clock", flags->clock, "simulated (repeatable, fast) or real")
      ->capture_default_str();
  command->add_option("--force-max-n", options.force_max_n, "Largest force [N]")
      ->capture_default_str();
  command->add_flag("--limit-stiffness", options.limit_stiffness,
                    "Scale forces to what the device can render");
  command
      ->add_option("--stream", flags->stream,
                   "Leave the responses in the file: auto (above 256 MiB), on or off")
      ->capture_default_str();
  command
      ->add_option("--stream-budget", flags->stream_budget_mib,
                   "Memory for streamed responses [MiB]")
      ->capture_default_str();
  command->add_option("--record", flags->record,
                      "Record every tick into this file, for replay");
  command->add_option("--flight-recorder", flags->flight_recorder,
                      "On a fault, write the last seconds into this file");
  command->add_option("--device", flags->device,
                      "Socket of a device's driver instead of the simulated device "
                      "(runtime/socket_device.h)");
  command
      ->add_option("--ramp-s", options.ramp_s,
                   "Time from the start until the largest force is allowed [s]")
      ->capture_default_str();
  command->add_option("--cpu", options.cpu,
                      "Keep the fast thread on this CPU (--clock real)");
  command->add_flag("--json", flags->json, "Print the report for programs");
  command->callback([flags] {
    run(*flags);
  });
}

}  // namespace palpate
