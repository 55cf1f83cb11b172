#include "runtime/run/prepared_run.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/tool_support.h"
#include "runtime/run/hand_seat.h"
#include "runtime/run/pose_trace.h"
#include "runtime/run/posed_device.h"
#include "runtime/run/recorded_setup.h"
#include "runtime/run/several_run.h"

namespace palpate {
namespace {

RenderConfig render_config(const SimulationOptions& options, const ToolShape& tool) {
  RenderConfig config;
  config.fast.fast.model = options.model;
  config.fast.fast.tool_radius_m = nominal_height_m(tool);
  config.fast.fast.force_max_n = options.force_max_n;
  config.fast.fast.ramp_s = options.ramp_s;
  config.fast.rate_hz = options.fast_hz;
  config.fast.stall_s = 5.0 / options.slow_hz;
  config.fast.stall_fault_s = std::max(0.5, 10.0 / options.slow_hz);
  if (options.attached || (options.together && options.together->attached)) {
    config.fast.speed_max_m_per_s = kHandSpeedMaxMPerS;
  }
  config.slow_hz = options.slow_hz;
  config.duration_s = options.duration_s;
  config.cpu = options.cpu;
  check(config);
  return config;
}

// Scale [-] of forces that makes the body renderable; 1 if it is.
double force_scale(const SimulationReport& report, const DeviceLimits& limits) {
  const std::string reason =
      why_not_renderable(report.stiffness, report.bounds, limits, report.hold_s);
  if (reason.empty()) {
    return 1.0;
  }
  const double scale =
      report.bounds.renderable_n_per_m() / report.stiffness.largest_n_per_m();
  if (!report.options.limit_stiffness) {
    throw InputError(
        fmt::format("the device cannot render this: {}; --limit-stiffness scales "
                    "forces by {:.3g}",
                    reason, scale));
  }
  if (!(scale > 0.0)) {
    throw InputError(fmt::format("no scale makes this renderable: {}", reason));
  }
  return scale;
}

// What is looked at while a wire is rendered on. The holds create energy themselves.
WireLimits wire_limits(const SimulationReport& report, const DeviceLimits& device,
                       const FastConfig& fast) {
  WireLimits wire;
  if (!passive(fast.model)) {
    return wire;
  }
  const double k_n_per_m = report.force_scale * report.stiffness.largest_n_per_m();
  wire.damping_n_s_per_m = device.damping_n_s_per_m;
  wire.stiffness_n_per_m =
      k_n_per_m > 0.0 ? k_n_per_m : report.bounds.renderable_n_per_m();
  wire.delay_s = device.delay_s;
  wire.floor_j = fast.energy_floor_j;
  if (report.coupling) {
    // Of a held damper: what it gives after it took nothing, and what the model took.
    wire.damping_n_s_per_m += 2.0 * report.coupling->coupling.damper_n_s_per_m;
  }
  return wire;
}

void prepare_records(PreparedRun& run, const DeviceLimits& limits) {
  const RecordingRequest& wanted = run.report.options.recording;
  run.header = recording_header(run.report, run.config.fast, limits, run.several.get());
  if (!wanted.file.empty()) {
    run.recorder = std::make_unique<Recorder>(wanted.file, run.header);
  }
  if (!wanted.flight_file.empty()) {
    run.flight = std::make_unique<FlightLog>();
  }
}

using GivenPoses = std::shared_ptr<const std::vector<RenderTick>>;

// The poses of a file. They have the rate that they were measured at.
GivenPoses given_poses(SimulationOptions& o) {
  if (!are_simulated(o) || o.real_time) {
    throw InputError(
        "--poses go in simulated time, instead of devices: leave out --device and "
        "--clock real");
  }
  auto poses = read_poses(o.poses, o.together ? 2 : 1);
  const auto ticks = static_cast<double>(poses.size() - 1);
  const double seconds = seconds_in(poses.back().time_ns - poses.front().time_ns);
  constexpr double kSame = 1e-3;  // what rounding of times may do
  if (ticks > 0.0 && std::abs(ticks / seconds / o.fast_hz - 1.0) > kSame) {
    o.fast_hz = ticks / seconds;
    o.slow_hz = std::min(o.slow_hz, o.fast_hz);
  }
  o.duration_s = (ticks + 1.0) / o.fast_hz;
  return std::make_shared<const std::vector<RenderTick>>(std::move(poses));
}

// Instead of devices.
void pose(PreparedRun& run, const GivenPoses& poses) {
  const DeviceLimits limits = run.device->limits();
  run.device = std::make_unique<PosedDevice>(poses, 0, limits);
  if (run.second != nullptr) {
    run.second = std::make_unique<PosedDevice>(poses, 1, limits);
  }
}

// Room for every tick, so that the fast process allocates none.
void reserve_trace(PreparedRun& run) {
  constexpr double kTicksMax = 2e7;  // 7 GB
  const RenderConfig& c = run.config;
  const double ticks = std::ceil(c.duration_s * c.fast.rate_hz) + 1.0;
  if (run.report.options.trace.empty()) {
    return;
  }
  if (ticks > kTicksMax) {
    throw InputError(
        fmt::format("--trace keeps every tick in memory, at most {:.3g}, and this run "
                    "has {:.3g}: --record writes them as they come",
                    kTicksMax, ticks));
  }
  run.trace.reserve(static_cast<std::size_t>(ticks));
}

// Everything that coupled contacts have beside what one has.
void prepare_together(const PressedBody& body, std::optional<HandSeat>& second,
                      const Eigen::Vector3d& start_m, PreparedRun& run, Clock& clock) {
  SimulationReport& report = run.report;
  const SimulationOptions& o = report.options;
  const PressedTogether& together = *body.together;
  report.contacts = body.contacts;
  report.second_place = together.second_place;
  report.second_node = together.second_place.node;
  report.table_error = together.table_error;
  report.convex = together.convex;
  report.turning_n_m_per_rad = together.turning_n_m_per_rad;
  if (second) {
    run.second = make_device(
        o, *second, together.second_script(report.force_scale, o.device.hand_n_per_m),
        true, clock);
  }
  ContactsHeld held{.force_scale = report.force_scale, .watch = o.watch_contacts};
  held.torque_felt = are_simulated(o) && run.device->measures_turns();
  report.torque_felt = held.torque_felt;
  if (report.coupling) {
    held.coupling = report.coupling->coupling;
  }
  report.second_device = run.second != nullptr ? run.second->name() : "";
  run.several = body.several(run.config.fast.fast, held, start_m);
}

// What a run leaves behind: report, recording, flight log.
void finish(PreparedRun& run, const RenderReport& rendered) {
  SimulationReport& report = run.report;
  report.render = rendered;
  if (report.coupling && rendered.coupling) {
    report.coupling->account = *rendered.coupling;
  }
  report.device_failure = run.device->failure();
  if (run.second != nullptr && report.device_failure.empty()) {
    report.device_failure = run.second->failure();
    if (!report.device_failure.empty()) {
      report.device_failure = fmt::format("second hand's {}: {}", report.second_device,
                                          report.device_failure);
    }
  }
  report.device_turns = run.device->measures_turns();
  if (const LinkReport* wire = run.device->wire()) {
    report.wire = *wire;
  }
  if (const LinkReport* wire = run.second ? run.second->wire() : nullptr) {
    report.second_wire = *wire;
  }
  const std::string_view fault = name(rendered.fault);
  if (run.recorder != nullptr) {
    run.recorder->finish(fault);
    report.records_dropped = run.recorder->dropped();
    report.recording_failure = run.recorder->failure();
  }
  if (!report.options.trace.empty()) {
    write_pose_trace(report.options.trace, report.options.together ? 2 : 1, run.trace);
  }
  if (run.flight != nullptr && rendered.fault != Fault::kNone) {
    write_flight_log(report.options.recording.flight_file, run.header, *run.flight,
                     fault);
  }
}

// Renders all of them at once, and records what is wanted of it.
void render(std::vector<PreparedRun>& runs, const std::atomic<bool>& stop,
            Clock& clock) {
  std::vector<RenderedTool> tools;
  tools.reserve(runs.size());
  for (PreparedRun& run : runs) {
    tools.push_back({run.config,
                     {.device = *run.device,
                      .stream = run.sender.get(),
                      .stop = stop,
                      .trace = run.report.options.trace.empty() ? nullptr : &run.trace,
                      .recorder = run.recorder.get(),
                      .flight = run.flight.get(),
                      .watch = run.report.options.watch,
                      .watch_needle = run.report.options.watch_needle,
                      .watch_friction = run.report.options.watch_friction,
                      .surface = run.header.surface,
                      .several = run.several.get(),
                      .second = run.second.get()}});
  }
  const std::vector<RenderReport> rendered = runs.front().report.options.real_time
                                                 ? render_in_real_time(tools)
                                                 : render_in_turns(tools, clock);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    finish(runs[i], rendered[i]);
  }
}

// The clock that a run goes by.
std::unique_ptr<Clock> make_clock(const SimulationOptions& options) {
  if (options.real_time) {
    return std::make_unique<MonotonicClock>();
  }
  return std::make_unique<SimulatedClock>();
}
}  // namespace

void check(const SimulationOptions& options) {
  if (!(options.force_max_n > 0.0) || !std::isfinite(options.force_max_n)) {
    throw InputError(fmt::format("largest force is {} N, must be positive and finite",
                                 options.force_max_n));
  }
  if (!are_simulated(options) && !options.real_time) {
    throw InputError("a device lives in real time, not in simulated time");
  }
}

PreparedRun prepare(const PressedBody& body, const SimulationOptions& wanted,
                    Clock& clock) {
  check_several(body.tool, wanted, body.several != nullptr);
  SimulationOptions options = wanted;
  const GivenPoses poses = wanted.poses.empty() ? nullptr : given_poses(options);
  PreparedRun run;
  run.config = render_config(options, body.tool);
  SimulationReport& report = run.report;
  report.options = options;
  report.tool = body.tool.name;
  report.tables = body.tables.empty() ? std::vector{body.tool.name} : body.tables;
  report.place = body.place;
  report.node = body.place.node;
  report.options.device.tick_s = 1.0 / wanted.fast_hz;  // whatever poses' rate is
  report.options.device.force_max_n = options.force_max_n;
  HandSeat seat = seat_of(report.options, options.socket, options.attached);
  std::optional<HandSeat> second;
  report.hold_s =
      hold_s(options.model, wanted.fast_hz, wanted.slow_hz, seat.limits.hold_s);
  DeviceLimits limits = seat.limits;
  if (options.together) {
    second.emplace(
        seat_of(report.options, options.together->socket, options.together->attached));
    limits = weaker(limits, second->limits, report.hold_s);
  }
  run.config.fast.fast.force_max_n = std::min(options.force_max_n, limits.force_max_n);
  report.stiffness = body.stiffness;
  if (!follows_surface(options.model)) {
    report.stiffness.friction_n_per_m = 0.0;  // the scalar models render none
  }
  report.bounds = stability_bounds(limits, report.hold_s);
  if (options.coupling) {
    soften_coupling(report, limits);
  }
  report.force_scale = force_scale(report, limits);
  if (!are_simulated(options)) {
    run.config.fast.wire = wire_limits(report, limits, run.config.fast.fast);
  }

  const HandScript script =
      body.script(report.force_scale, options.device.hand_n_per_m);
  run.device =
      options.wander_m_per_s > 0.0
          ? wandering_device(body, options, report.options.device, clock)
          : make_device(report.options, seat, script, body.several != nullptr, clock);
  report.device = run.device->name();
  const Eigen::Vector3d start_m = script.at(0.0).position_m;
  if (body.several) {
    prepare_together(body, second, start_m, run, clock);
  } else if (body.growing) {
    run.sender = body.growing(report.bounds.renderable_n_per_m());
  } else {
    run.sender = body.stream(report.force_scale, start_m);
  }
  if (poses != nullptr) {
    pose(run, poses);
  }
  reserve_trace(run);
  prepare_records(run, limits);
  return run;
}

std::vector<PreparedRun> run_all(std::span<const SimulationOptions> tools,
                                 const std::atomic<bool>& stop,
                                 const PrepareOne& prepare_one) {
  if (tools.empty()) {
    throw InputError("a scene without a tool cannot be rendered");
  }
  const std::unique_ptr<Clock> clock = make_clock(tools.front());
  std::vector<PreparedRun> runs;
  for (const SimulationOptions& options : tools) {
    if (options.real_time != tools.front().real_time) {
      throw InputError("tools of one scene share the clock, real or simulated");
    }
    runs.push_back(prepare_one(options, *clock));
  }
  render(runs, stop, *clock);
  return runs;
}
}  // namespace palpate
