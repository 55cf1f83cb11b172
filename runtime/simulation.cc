#include "runtime/simulation.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include <fmt/format.h>

#include "formats/error.h"
#include "runtime/hand_place.h"
#include "runtime/recorder.h"
#include "runtime/render_loop.h"
#include "runtime/replay.h"
#include "runtime/socket_device.h"
#include "runtime/streamed_place.h"

namespace palpate {
namespace {

RenderConfig render_config(const SimulationOptions& options, const ToolShape& tool) {
  RenderConfig config;
  config.fast.fast.model = options.model;
  config.fast.fast.tool_radius_m = tool.radius_m;
  config.fast.fast.force_max_n = options.force_max_n;
  config.fast.fast.ramp_s = options.ramp_s;
  config.fast.rate_hz = options.fast_hz;
  config.fast.stall_s = 5.0 / options.slow_hz;
  config.fast.stall_fault_s = std::max(0.5, 10.0 / options.slow_hz);
  config.slow_hz = options.slow_hz;
  config.duration_s = options.duration_s;
  config.cpu = options.cpu;
  check(config);
  return config;
}

void check(const SimulationOptions& options, const ToolShape& tool) {
  if (!(options.force_max_n > 0.0) || !std::isfinite(options.force_max_n)) {
    throw InputError(fmt::format("largest force is {} N, must be positive and finite",
                                 options.force_max_n));
  }
  if ((!options.socket.empty() || options.attached) && !options.real_time) {
    throw InputError("a device lives in real time, not in simulated time");
  }
  if (tool.kind != "sphere") {
    throw InputError(fmt::format("tool {:?} is a {}, only spheres can be rendered",
                                 tool.name, tool.kind));
  }
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

// What a run presses, wherever its responses lie.
struct PressedBody {
  ToolShape tool;
  std::int32_t node = -1;
  RenderedStiffness stiffness;
  std::function<HandScript(double force_scale, double hand_n_per_m)> script;
  std::function<std::unique_ptr<ElementSender>(double force_scale,
                                               const Eigen::Vector3d& start_m)>
      stream;
};

// Renders, and records what is wanted of it.
void render(const RenderConfig& config, RenderSetup setup, Clock& clock,
            SimulationReport& report) {
  const SimulationOptions& options = report.options;
  const RecordingRequest& wanted = options.recording;
  const RecordingHeader header =
      recording_header(report, config.fast, setup.device.limits(), wanted);
  std::unique_ptr<Recorder> recorder;
  if (!wanted.file.empty()) {
    recorder = std::make_unique<Recorder>(wanted.file, header);
    setup.recorder = recorder.get();
  }
  std::unique_ptr<FlightLog> flight;
  if (!wanted.flight_file.empty()) {
    flight = std::make_unique<FlightLog>();
    setup.flight = flight.get();
  }
  report.render = options.real_time ? render_in_real_time(config, setup)
                                    : render_in_turns(config, setup, clock);
  const std::string_view fault = name(report.render.fault);
  if (recorder != nullptr) {
    recorder->finish(fault);
    report.records_dropped = recorder->dropped();
    report.recording_failure = recorder->failure();
  }
  if (flight != nullptr && report.render.fault != Fault::kNone) {
    write_flight_log(wanted.flight_file, header, *flight, fault);
  }
}

// @param sender who sent the elements, for the caller's account of it.
SimulationReport run(const PressedBody& body, const SimulationOptions& options,
                     const std::atomic<bool>& stop,
                     std::unique_ptr<ElementSender>& sender) {
  RenderConfig config = render_config(options, body.tool);
  SimulationReport report;
  report.options = options;
  report.tool = body.tool.name;
  report.node = body.node;
  report.options.device.tick_s = 1.0 / options.fast_hz;
  report.options.device.force_max_n = options.force_max_n;
  const SimulatedDeviceConfig& device_config = report.options.device;

  MonotonicClock monotonic;
  SimulatedClock simulated;
  Clock& clock = options.real_time ? static_cast<Clock&>(monotonic) : simulated;
  std::unique_ptr<Device> device;
  if (!options.socket.empty()) {
    device = std::make_unique<SocketDevice>(options.socket);
  }
  const DeviceLimits limits =
      options.attached ? options.attached->limits
      : device != nullptr
          ? device->limits()
          : SimulatedDevice(device_config, HandScript{}, clock, {}).limits();
  config.fast.fast.force_max_n = std::min(options.force_max_n, limits.force_max_n);
  report.hold_s = hold_s(options.model, options.fast_hz, options.slow_hz);
  report.stiffness = body.stiffness;
  if (!follows_surface(options.model)) {
    report.stiffness.friction_n_per_m = 0.0;  // the scalar models render none
  }
  report.bounds = stability_bounds(limits, report.hold_s);
  report.force_scale = force_scale(report, limits);

  const HandScript script = body.script(report.force_scale, device_config.hand_n_per_m);
  const Eigen::Vector3d start_m = script.at(0.0).position_m;
  if (options.attached) {
    device = options.attached->make(script);
  } else if (device == nullptr) {
    device = std::make_unique<SimulatedDevice>(device_config, script, clock,
                                               SimulatedMotion{.position_m = start_m});
  }
  report.device = device->name();
  sender = body.stream(report.force_scale, start_m);
  render(config, {.device = *device, .stream = *sender, .stop = stop}, clock, report);
  report.device_failure = device->failure();
  return report;
}

}  // namespace

std::string known_models() {
  std::string names;
  for (const LocalModel model : kLocalModels) {
    names += (names.empty() ? "" : ", ") + std::string(name(model));
  }
  return names;
}

LocalModel requested_model(const std::string& model) {
  const auto known = local_model(model);
  if (!known) {
    throw InputError(fmt::format("--model {}: unknown local model; known: {}", model,
                                 known_models()));
  }
  return *known;
}

double hold_s(LocalModel model, double fast_hz, double slow_hz) {
  const bool slow =
      model == LocalModel::kSingle || model == LocalModel::kFirstOrderHold;
  return 1.0 / (slow ? slow_hz : fast_hz);
}

SimulationReport simulate(const ResponseDatabase& database,
                          const SimulationOptions& options,
                          const std::atomic<bool>& stop) {
  const ResponseTable& table = find_tool(database, options.tool);
  check(options, table.tool);
  const std::int32_t node = node_to_press(database, table, options.at_m);
  ResampleLoss loss;
  const PressedBody body{
      .tool = table.tool,
      .node = node,
      .stiffness = rendered_stiffness(table, options.force_max_n),
      .script =
          [&](double scale, double hand_n_per_m) {
            return script_at(database, table, node, options.force_max_n, scale,
                             hand_n_per_m);
          },
      .stream = [&](double scale,
                    const Eigen::Vector3d&) -> std::unique_ptr<ElementSender> {
        auto stream = std::make_unique<ElementStream>(database, table, scale);
        loss = stream->resample_loss();
        return stream;
      }};
  std::unique_ptr<ElementSender> sender;
  SimulationReport report = run(body, options, stop, sender);
  report.resample_loss = loss;
  return report;
}

SimulationReport simulate_streamed(const std::filesystem::path& file,
                                   const SimulationOptions& options,
                                   std::size_t budget_bytes,
                                   const std::atomic<bool>& stop) {
  const ChunkReader reader(file);
  const std::size_t tool = find_tool(reader.index(), options.tool);
  check(options, reader.index().tools[tool].tool);
  const StreamedPlace place = streamed_place(reader, tool, options.at_m);
  const PressedBody body{
      .tool = reader.index().tools[tool].tool,
      .node = place.source_node,
      .stiffness = streamed_stiffness(reader, tool, options.force_max_n),
      .script =
          [&](double scale, double hand_n_per_m) {
            return script_at(place.around, place.around.tools[0], place.row,
                             options.force_max_n, scale, hand_n_per_m);
          },
      .stream = [&](double scale,
                    const Eigen::Vector3d& start_m) -> std::unique_ptr<ElementSender> {
        const CacheOptions cache{
            .tool = options.tool, .budget_bytes = budget_bytes, .force_scale = scale};
        return std::make_unique<StreamedElements>(file, cache, start_m,
                                                  options.real_time);
      }};
  std::unique_ptr<ElementSender> sender;
  SimulationReport report = run(body, options, stop, sender);
  auto& streamed = dynamic_cast<StreamedElements&>(*sender);
  streamed.stop();
  report.stream = streamed.report();
  report.resample_loss = report.stream->cache.loss;
  return report;
}

}  // namespace palpate
