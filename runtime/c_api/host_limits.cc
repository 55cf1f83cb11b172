#include "runtime/c_api/host_limits.h"

#include <limits>
#include <string>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/tool_support.h"

namespace palpate {

FastConfig fast_config(const HostOptions& options, const ToolShape& tool) {
  FastConfig fast;
  fast.model = options.model;
  fast.tool_radius_m = nominal_height_m(tool);
  fast.force_max_n = options.force_max_n / options.force_gain;
  fast.slew_max_n_per_s /= options.force_gain;
  fast.ramp_s = options.ramp_s;
  return fast;
}

namespace {

DeviceLimits device_limits(const HostOptions& options) {
  return {.damping_n_s_per_m = options.damping_n_s_per_m,
          .delay_s = options.delay_s,
          .force_max_n = options.force_max_n};
}

}  // namespace

double renderable_n_per_m(const HostOptions& options) {
  if (options.damping_n_s_per_m == 0.0) {
    return std::numeric_limits<double>::infinity();
  }
  return stability_bounds(device_limits(options), options.tick_s).renderable_n_per_m() /
         (options.position_gain * options.force_gain);
}

double renderable_scale(const HostOptions& options, RenderedStiffness stiffness) {
  if (options.damping_n_s_per_m == 0.0) {
    return 1.0;
  }
  const DeviceLimits device = device_limits(options);
  const double felt = options.position_gain * options.force_gain;
  stiffness.normal_n_per_m *= felt;
  stiffness.shaft_n_per_m *= felt;
  stiffness.lateral_n_per_m *= felt;
  stiffness.friction_n_per_m *= felt;
  const StabilityBounds bounds = stability_bounds(device, options.tick_s);
  const std::string reason =
      why_not_renderable(stiffness, bounds, device, options.tick_s);
  if (reason.empty()) {
    return 1.0;
  }
  if (!options.limit_stiffness) {
    throw InputError(fmt::format(
        "the device cannot render this: {} at gains of {:.4g} times, felt at the "
        "device; the flag to limit stiffness scales forces by {:.3g}",
        reason, felt, bounds.renderable_n_per_m() / stiffness.largest_n_per_m()));
  }
  return bounds.renderable_n_per_m() / stiffness.largest_n_per_m();
}

double contacts_scale(const HostOptions& options, const ContactStiffness& contacts) {
  if (options.damping_n_s_per_m == 0.0) {
    return 1.0;
  }
  // Of the device: turns are as they are, arms as long as its own movement makes them.
  ContactStiffness felt = contacts;
  felt.lever_m /= options.position_gain;
  felt.n_per_m *= options.position_gain * options.force_gain;
  felt.friction_n_per_m *= options.position_gain * options.force_gain;
  const WrenchMargin margin =
      wrench_margin(felt, options.damping_n_s_per_m, options.angular_damping_n_m_s,
                    options.tick_s, options.delay_s);
  const std::string reason = why_not_renderable(margin, options.damping_n_s_per_m,
                                                options.angular_damping_n_m_s);
  if (reason.empty()) {
    return 1.0;
  }
  if (!options.limit_stiffness) {
    throw InputError(
        fmt::format("the device cannot render this: {}; the flag to limit stiffness "
                    "scales forces by {:.3g}",
                    reason, 1.0 / margin.share));
  }
  return 1.0 / margin.share;
}

}  // namespace palpate
