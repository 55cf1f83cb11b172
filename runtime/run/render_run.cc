#include "runtime/run/render_run.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/tool_support.h"
#include "runtime/device/socket_device.h"
#include "runtime/hand/press_site.h"
#include "runtime/render/recorder.h"
#include "runtime/render/render_loop.h"
#include "runtime/render/several_contacts.h"
#include "runtime/run/replay.h"
#include "runtime/run/several_run.h"
#include "runtime/slow/contact_stiffness.h"
#include "runtime/slow/file_press_site.h"

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
  if (options.attached) {
    constexpr double kHandMax = 3.0;  // [m/s] no hand moves a tool faster
    config.fast.speed_max_m_per_s = kHandMax;
  }
  config.slow_hz = options.slow_hz;
  config.duration_s = options.duration_s;
  config.cpu = options.cpu;
  check(config);
  return config;
}

void check(const SimulationOptions& options) {
  if (!(options.force_max_n > 0.0) || !std::isfinite(options.force_max_n)) {
    throw InputError(fmt::format("largest force is {} N, must be positive and finite",
                                 options.force_max_n));
  }
  if ((!options.socket.empty() || options.attached) && !options.real_time) {
    throw InputError("a device lives in real time, not in simulated time");
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
  // Of a tool of several contacts, instead of the stream.
  std::function<std::unique_ptr<RenderedBody>(
      const FastConfig& config, double force_scale,
      const std::optional<CouplingReport>& coupling)>
      several = nullptr;
  std::function<HandScript(double force_scale, double hand_n_per_m)> script;
  std::function<std::unique_ptr<ElementSender>(double force_scale,
                                               const Eigen::Vector3d& start_m)>
      stream;
};

// A run of one tool, ready to be rendered.
struct PreparedRun {
  RenderConfig config;
  SimulationReport report;
  std::unique_ptr<Device> device;
  std::unique_ptr<ElementSender> sender;
  std::unique_ptr<RenderedBody> several;  // instead of a sender
  RecordingHeader header;
  std::unique_ptr<Recorder> recorder;
  std::unique_ptr<FlightLog> flight;
};

void prepare_records(PreparedRun& run, const DeviceLimits& limits) {
  const RecordingRequest& wanted = run.report.options.recording;
  run.header = recording_header(run.report, run.config.fast, limits, wanted);
  if (!wanted.file.empty()) {
    run.recorder = std::make_unique<Recorder>(wanted.file, run.header);
  }
  if (!wanted.flight_file.empty()) {
    run.flight = std::make_unique<FlightLog>();
  }
}

// Checks the margin. @param clock of all tools.
PreparedRun prepare(const PressedBody& body, const SimulationOptions& options,
                    Clock& clock) {
  check_several(body.tool, options, body.several != nullptr);
  PreparedRun run;
  run.config = render_config(options, body.tool);
  SimulationReport& report = run.report;
  report.options = options;
  report.tool = body.tool.name;
  report.node = body.node;
  report.options.device.tick_s = 1.0 / options.fast_hz;
  report.options.device.force_max_n = options.force_max_n;
  const SimulatedDeviceConfig& device_config = report.options.device;
  if (!options.socket.empty()) {
    run.device = std::make_unique<SocketDevice>(options.socket);
  }
  const DeviceLimits limits =
      options.attached ? options.attached->limits
      : run.device != nullptr
          ? run.device->limits()
          : SimulatedDevice(device_config, HandScript{}, clock, {}).limits();
  run.config.fast.fast.force_max_n = std::min(options.force_max_n, limits.force_max_n);
  report.hold_s = hold_s(options.model, options.fast_hz, options.slow_hz);
  report.stiffness = body.stiffness;
  if (!follows_surface(options.model)) {
    report.stiffness.friction_n_per_m = 0.0;  // the scalar models render none
  }
  report.bounds = stability_bounds(limits, report.hold_s);
  if (options.coupling) {
    soften_coupling(report, limits);
  }
  report.force_scale = force_scale(report, limits);

  const HandScript script = body.script(report.force_scale, device_config.hand_n_per_m);
  const Eigen::Vector3d start_m = script.at(0.0).position_m;
  if (options.attached) {
    run.device = options.attached->make(script);
  } else if (run.device == nullptr) {
    run.device = std::make_unique<SimulatedDevice>(
        device_config, script, clock, SimulatedMotion{.position_m = start_m});
  }
  report.device = run.device->name();
  if (body.several) {
    report.contacts = static_cast<int>(body.tool.contact.radius_m.size());
    run.several =
        body.several(run.config.fast.fast, report.force_scale, report.coupling);
  } else {
    run.sender = body.stream(report.force_scale, start_m);
  }
  prepare_records(run, limits);
  return run;
}

// What a run leaves behind: report, recording, flight log.
void finish(PreparedRun& run, const RenderReport& rendered) {
  SimulationReport& report = run.report;
  report.render = rendered;
  if (report.coupling && rendered.coupling) {
    report.coupling->account = *rendered.coupling;
  }
  report.device_failure = run.device->failure();
  if (const LinkReport* wire = run.device->wire()) {
    report.wire = *wire;
  }
  const std::string_view fault = name(rendered.fault);
  if (run.recorder != nullptr) {
    run.recorder->finish(fault);
    report.records_dropped = run.recorder->dropped();
    report.recording_failure = run.recorder->failure();
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
                      .recorder = run.recorder.get(),
                      .flight = run.flight.get(),
                      .watch = run.report.options.watch,
                      .surface = run.header.surface,
                      .several = run.several.get()}});
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

// Prepares a run for each tool, and renders all of them at once.
template <typename PrepareOne>
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

std::vector<SimulationReport> reports(const std::vector<PreparedRun>& runs) {
  std::vector<SimulationReport> all;
  for (const PreparedRun& run : runs) {
    all.push_back(run.report);
  }
  return all;
}

// A tool of several contacts.
PressedBody pressed_by_several(const ResponseDatabase& database,
                               const ResponseTable& table, PressedBody body,
                               const SimulationOptions& options) {
  body.stiffness = stiffness_of_contacts(database, table, options.force_max_n);
  body.several = [&database, &table, watch = options.watch_contacts](
                     const FastConfig& config, double scale,
                     const std::optional<CouplingReport>& coupling) {
    return std::make_unique<SeveralContacts>(
        database, table, config, scale,
        coupling ? std::optional(coupling->coupling) : std::nullopt, watch);
  };
  body.script = [script = std::move(body.script), &table](double scale,
                                                          double hand_n_per_m) {
    HandScript pressed = script(scale, hand_n_per_m);
    const ContactSet& contact = table.tool.contact;
    pressed.touch_m = (Eigen::Map<const Eigen::VectorXd>(contact.radius_m.data(),
                                                         std::ssize(contact.radius_m)) -
                       contact.point_m * pressed.normal)
                          .maxCoeff();
    return pressed;
  };
  return body;
}

// @param loss of the curves that had to be thinned.
PressedBody pressed_body(const ResponseDatabase& database,
                         const SimulationOptions& options, ResampleLoss& loss) {
  const ResponseTable& table = find_tool(database, options.tool);
  check(options);
  const std::int32_t node = node_to_press(database, table, options.at_m);
  const double force_max_n = options.force_max_n;
  PressedBody body{
      .tool = table.tool,
      .node = node,
      .stiffness = rendered_stiffness(table, force_max_n),
      .script =
          [&database, &table, node, force_max_n](double scale, double hand_n_per_m) {
            return script_at(database, table, node, force_max_n, scale, hand_n_per_m);
          },
      .stream = [&database, &table, &loss](double scale, const Eigen::Vector3d&)
          -> std::unique_ptr<ElementSender> {
        auto stream = std::make_unique<ElementStream>(database, table, scale);
        loss = stream->resample_loss();
        return stream;
      }};
  return table.tool.contact.empty()
             ? body
             : pressed_by_several(database, table, std::move(body), options);
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
  return simulate(database, std::span(&options, 1), stop).front();
}

std::vector<SimulationReport> simulate(const ResponseDatabase& database,
                                       std::span<const SimulationOptions> tools,
                                       const std::atomic<bool>& stop) {
  const auto prepare_one = [&](const SimulationOptions& options, Clock& clock) {
    ResampleLoss loss;
    PreparedRun run = prepare(pressed_body(database, options, loss), options, clock);
    run.report.resample_loss = loss;
    return run;
  };
  return reports(run_all(tools, stop, prepare_one));
}

std::vector<SimulationReport> simulate_streamed(
    const std::filesystem::path& file, std::span<const SimulationOptions> tools,
    std::size_t budget_bytes, const std::atomic<bool>& stop) {
  const ChunkReader reader(file);
  const auto prepare_one = [&](const SimulationOptions& options, Clock& clock) {
    const std::size_t tool = find_tool(reader.index(), options.tool);
    check(options);
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
        .stream = [&](double scale, const Eigen::Vector3d& start_m)
            -> std::unique_ptr<ElementSender> {
          const CacheOptions cache{.tool = options.tool,
                                   .budget_bytes = budget_bytes / tools.size(),
                                   .force_scale = scale};
          return std::make_unique<StreamedElements>(file, cache, start_m,
                                                    options.real_time);
        }};
    return prepare(body, options, clock);
  };
  std::vector<PreparedRun> runs = run_all(tools, stop, prepare_one);
  for (PreparedRun& run : runs) {
    auto& streamed = dynamic_cast<StreamedElements&>(*run.sender);
    streamed.stop();
    run.report.stream = streamed.report();
    run.report.resample_loss = run.report.stream->cache.loss;
  }
  return reports(runs);
}

}  // namespace palpate
