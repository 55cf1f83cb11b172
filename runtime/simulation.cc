#include "runtime/simulation.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/error.h"
#include "runtime/hand_place.h"
#include "runtime/render_loop.h"

namespace palpate {
namespace {

RenderConfig render_config(const SimulationOptions& options,
                           const ResponseTable& table) {
  RenderConfig config;
  config.fast.fast.model = options.model;
  config.fast.fast.tool_radius_m = table.tool.radius_m;
  config.fast.fast.force_max_n = options.force_max_n;
  config.fast.rate_hz = options.fast_hz;
  config.fast.stall_s = 5.0 / options.slow_hz;
  config.fast.stall_fault_s = std::max(0.5, 10.0 / options.slow_hz);
  config.slow_hz = options.slow_hz;
  config.duration_s = options.duration_s;
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
  if (!report.options.limit_stiffness) {
    throw InputError(fmt::format(
        "the device cannot render this: {}; --limit-stiffness scales it", reason));
  }
  const double scale =
      report.bounds.renderable_n_per_m() / report.stiffness.largest_n_per_m();
  if (!(scale > 0.0)) {
    throw InputError(fmt::format("no scale makes this renderable: {}", reason));
  }
  return scale;
}

}  // namespace

double hold_s(LocalModel model, double fast_hz, double slow_hz) {
  const bool slow =
      model == LocalModel::kSingle || model == LocalModel::kFirstOrderHold;
  return 1.0 / (slow ? slow_hz : fast_hz);
}

SimulationReport simulate(const ResponseDatabase& database,
                          const SimulationOptions& options,
                          const std::atomic<bool>& stop) {
  if (!(options.force_max_n > 0.0) || !std::isfinite(options.force_max_n)) {
    throw InputError(fmt::format("largest force is {} N, must be positive and finite",
                                 options.force_max_n));
  }
  const ResponseTable& table = find_tool(database, options.tool);
  if (table.tool.kind != "sphere") {
    throw InputError(fmt::format("tool {:?} is a {}, only spheres can be rendered",
                                 table.tool.name, table.tool.kind));
  }
  const RenderConfig config = render_config(options, table);
  SimulationReport report;
  report.options = options;
  report.tool = table.tool.name;
  report.node = node_to_press(database, table, options.at_m);
  report.options.device.tick_s = 1.0 / options.fast_hz;
  report.options.device.force_max_n = options.force_max_n;
  const SimulatedDeviceConfig& device_config = report.options.device;

  MonotonicClock monotonic;
  SimulatedClock simulated;
  Clock& clock = options.real_time ? static_cast<Clock&>(monotonic) : simulated;
  const DeviceLimits limits =
      SimulatedDevice(device_config, HandScript{}, clock, {}).limits();
  report.hold_s = hold_s(options.model, options.fast_hz, options.slow_hz);
  report.stiffness = rendered_stiffness(table, options.force_max_n);
  if (options.model != LocalModel::kElement) {
    report.stiffness.friction_n_per_m = 0.0;  // the scalar models render none
  }
  report.bounds = stability_bounds(limits, report.hold_s);
  report.force_scale = force_scale(report, limits);

  const HandScript script = script_at(database, table, report.node, options.force_max_n,
                                      report.force_scale, device_config.hand_n_per_m);
  SimulatedDevice device(device_config, script, clock,
                         {.position_m = script.at(0.0).position_m});
  ElementStream stream(database, table, report.force_scale);
  report.resample_loss = stream.resample_loss();
  const RenderSetup setup{.device = device, .stream = stream, .stop = stop};
  report.render = options.real_time ? render_in_real_time(config, setup)
                                    : render_in_turns(config, setup, clock);
  return report;
}

}  // namespace palpate
