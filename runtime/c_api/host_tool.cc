#include "runtime/c_api/host_tool.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

void check_range(const char* what, double value, double above, double most) {
  if (!(value > above && value <= most) || !std::isfinite(value)) {
    throw InputError(
        fmt::format("{} is {}, must lie above {} and be {}", what, value, above,
                    std::isfinite(most) ? fmt::format("at most {}", most) : "finite"));
  }
}

void check_not_negative(const char* what, double value) {
  if (!(value >= 0.0) || !std::isfinite(value)) {
    throw InputError(
        fmt::format("{} is {}, must be finite and not negative", what, value));
  }
}

// Angle of the rotation that a quaternion of any length stands for.
double angle_rad(const Eigen::Vector4d& quaternion) {
  return 2.0 * std::atan2(quaternion.head<3>().norm(), std::abs(quaternion.w()));
}

}  // namespace

// Beyond these, sums of what is scaled lose their digits.
void check_scale(const char* what, double value) {
  constexpr double kLargest = 1e6;
  if (!(value >= 1.0 / kLargest && value <= kLargest)) {
    throw InputError(fmt::format("{} is {}, must lie in [{:g}, {:g}]", what, value,
                                 1.0 / kLargest, kLargest));
  }
}

void check(const HostOptions& options) {
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  check_scale("unit of length [m]", options.metres_per_unit);
  check_scale("unit of force [N]", options.newtons_per_unit);
  check_scale("position gain", options.position_gain);
  check_scale("force gain", options.force_gain);
  check_range("nominal tick [s]", options.tick_s, 0.0, 1.0);
  check_range("slow rate [Hz]", options.slow_hz, 0.0, 1000.0);
  if (options.slow_hz < 1.0) {
    throw InputError(
        fmt::format("slow rate is {} Hz, must be at least 1", options.slow_hz));
  }
  check_not_negative("device damping [N s/m]", options.damping_n_s_per_m);
  check_not_negative("device angular damping [N m s]", options.angular_damping_n_m_s);
  check_not_negative("device delay [s]", options.delay_s);
  check_range("largest force [N]", options.force_max_n, 0.0, kEndless);
  check_range("stall limit [s]", options.stall_s, 0.0, kEndless);
  check_range("start-up ramp [s]", options.ramp_s, 0.0, kEndless);
  const bool of_scene =
      options.estimate || !options.server.empty() || !options.output.empty();
  if (of_scene && !options.scene) {
    throw InputError(
        "server, output and estimate are of a scene that is computed "
        "meanwhile: its flag is not set");
  }
  if (options.scene && options.streamed) {
    throw InputError("a scene that is computed meanwhile is not streamed");
  }
}

LocalModel passive_model(std::string_view name) {
  const std::optional<LocalModel> model = local_model(name);
  if (!model || !passive(*model)) {
    std::string known;
    for (const LocalModel each : kLocalModels) {
      if (passive(each)) {
        known += (known.empty() ? "" : ", ") + std::string(palpate::name(each));
      }
    }
    throw InputError(
        fmt::format("model \"{}\" is none of the passive ones: {}", name, known));
  }
  return *model;
}

DeviceReading HostTool::reading_of(const HostSample& sample) const noexcept {
  DeviceReading reading;
  reading.position_m = placement_.point_in_body(sample.position_m);
  reading.time_ns = time_ns_;
  if (!body_->turns()) {
    return reading;  // one contact does not turn
  }
  const Eigen::Vector4d q = placement_.turn_in_body(sample.quaternion);
  const double length = q.stableNorm();
  if (length > 0.0) {
    reading.turn = Eigen::Quaterniond(Eigen::Vector4d(q / length));
  }
  return reading;
}

FastContact HostTool::contact() const noexcept {
  FastContact at = body_->contact();
  at.tool_m = placement_.point_in_world(at.tool_m);
  at.point_m = placement_.point_in_world(at.point_m);
  at.normal = placement_.vector_in_world(at.normal);
  return at;
}

HostTick HostTool::step(std::span<const HostSample> samples) noexcept {
  const HostSample& first = samples[0];
  const double dt_s = first.dt_s == 0.0 ? tick_s_ : first.dt_s;
  ArrivalRecord arrival;
  for (int taken = 0; taken < kElementsATick && body_->take_in(arrival); ++taken) {
    silent_s_ = 0.0;
  }
  if (dt_s > 0.0 && dt_s <= 1.0) {  // any other is a fault of the step
    time_ns_ += std::llround(dt_s * kNanosecondsPerSecond);
    silent_s_ += dt_s;
  }
  if (body_->in_contact() && silent_s_ > stall_s_) {
    body_->raise(Fault::kSlowStalled);
  }
  HandReadings reading;
  bool placed = true;
  for (std::size_t hand = 0; hand < samples.size(); ++hand) {
    reading[hand] = reading_of(samples[hand]);
    placed = placed && samples[hand].position_m.allFinite();
    if (!samples[hand].quaternion.allFinite()) {
      body_->raise(Fault::kNotFinite);
    }
  }
  body_->feel_torque(first.torque_felt);
  HostTick tick;
  tick.command = body_->step(reading, dt_s);
  for (std::size_t hand = 0; hand < samples.size(); ++hand) {
    tick.command.wrench[hand] = placement_.in_world(tick.command.wrench[hand]);
  }
  wanted_ = tick.command.wrench;
  tick.contact = contact();
  tick.work_j = body_->work_j();
  if (!body_->turns() && first.quaternion.allFinite()) {
    tick.tilt_rad = angle_rad(placement_.turn_in_body(first.quaternion));
  }
  tick.ticks = ++ticks_;
  latest_.write(tick);
  if (placed) {
    body_->publish(reading, ++sequence_);
  }
  return tick;
}

bool HostTool::delivered(const PortWrenches& made) noexcept {
  for (const Wrench& wrench : made) {
    if (!wrench.force_n.allFinite() || !wrench.torque_n_m.allFinite()) {
      return false;
    }
  }
  PortWrenches in_body;
  for (std::size_t hand = 0; hand < made.size(); ++hand) {
    in_body[hand] = placement_.in_body(made[hand]);
  }
  body_->delivered(in_body);
  return true;
}

BodyContact HostTool::contact_at(int i) const noexcept {
  BodyContact contact = body_->contact_at(i);
  ContactPlace& at = contact.at;
  at.centre_m = placement_.point_in_world(at.centre_m);
  at.point_m = placement_.point_in_world(at.point_m);
  at.normal = placement_.vector_in_world(at.normal);
  at.force_n = placement_.vector_in_world(at.force_n);
  return contact;
}

NeedleSeen HostTool::needle() const noexcept {
  NeedleSeen seen = body_->needle();
  seen.lateral_n = placement_.vector_in_world(seen.lateral_n);
  return seen;
}

Channel HostTool::channel_at(std::int32_t i) const noexcept {
  Channel channel = body_->needle().state.channel[static_cast<std::size_t>(i)];
  channel.entry_m = placement_.point_in_world(channel.entry_m);
  channel.axis = placement_.vector_in_world(channel.axis);
  channel.lateral_m = placement_.vector_in_world(channel.lateral_m);
  return channel;
}

void HostTool::reset() noexcept {
  body_->restart();
  silent_s_ = 0.0;
  ticks_ = 0;
  latest_.write({});
}

void HostTool::begin_with(const KeptSurface& kept) {
  body_->begin_with(kept);
  reset();
}

HostTick HostTool::latest() noexcept {
  static_cast<void>(latest_.fetch());
  return latest_.latest();
}

}  // namespace palpate
