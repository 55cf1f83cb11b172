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
#include "runtime/c_api/host_contacts.h"
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

HostTool::HostTool(const FastConfig& fast, double tick_s, double stall_s)
    : config_(fast), tick_s_(tick_s), stall_s_(stall_s) {
  state_.config = config_;
}

HostTool::HostTool(std::unique_ptr<HostContacts> contacts, const FastConfig& fast,
                   double tick_s, double stall_s)
    : HostTool(fast, tick_s, stall_s) {
  contacts_ = std::move(contacts);
}

HostTool::~HostTool() = default;

void HostTool::take_elements() noexcept {
  for (int taken = 0; taken < kElementsATick; ++taken) {
    const Element* element = exchange_.elements.front();
    if (element == nullptr) {
      return;
    }
    accept(state_, *element);
    exchange_.elements.pop();
    silent_s_ = 0.0;
  }
}

HostTick HostTool::step(std::span<const HostSample> samples) noexcept {
  const HostTick tick = contacts_->step(samples);
  wanted_ = tick.command.wrench;
  latest_.write(tick);
  return tick;
}

HostTick HostTool::step(const HostSample& sample) noexcept {
  if (contacts_ != nullptr) {
    return step(std::span(&sample, 1));
  }
  const double dt_s = sample.dt_s == 0.0 ? tick_s_ : sample.dt_s;
  take_elements();
  if (!sample.quaternion.allFinite()) {
    raise_fault(state_, Fault::kNotFinite);
  }
  if (dt_s > 0.0 && dt_s <= 1.0) {  // any other is a fault of the step
    time_ns_ += std::llround(dt_s * kNanosecondsPerSecond);
    silent_s_ += dt_s;
  }
  if (state_.in_contact && silent_s_ > stall_s_) {
    raise_fault(state_, Fault::kSlowStalled);
  }
  HostTick tick;
  tick.command = as_wrench(palpate::step(
      state_, {.position_m = sample.position_m, .time_ns = time_ns_}, dt_s));
  wanted_ = tick.command.wrench;
  tick.contact = contact(state_);
  tick.work_j = state_.ledger.work_j;
  tick.tilt_rad = sample.quaternion.allFinite() ? angle_rad(sample.quaternion) : 0.0;
  tick.ticks = ++ticks_;
  latest_.write(tick);
  if (sample.position_m.allFinite()) {
    exchange_.tool.write({.sequence = ++sequence_,
                          .time_ns = time_ns_,
                          .position_m = sample.position_m,
                          .triangle = tick.contact.triangle,
                          .in_contact = tick.contact.in_contact});
  }
  return tick;
}

bool HostTool::delivered(const PortWrenches& made) noexcept {
  for (const Wrench& wrench : made) {
    if (!wrench.force_n.allFinite() || !wrench.torque_n_m.allFinite()) {
      return false;
    }
  }
  if (contacts_ != nullptr) {
    contacts_->delivered(made);
  } else {
    palpate::delivered(state_, made[0].force_n);
  }
  return true;
}

void HostTool::reset() noexcept {
  if (contacts_ != nullptr) {
    contacts_->reset();
  }
  kept_ = state_.memory.yielded;
  std::construct_at(&state_);
  state_.config = config_;
  state_.memory.yielded = kept_;
  silent_s_ = 0.0;
  ticks_ = 0;
  // What is under way is of the place before.
  while (exchange_.elements.front() != nullptr) {
    exchange_.elements.pop();
  }
  latest_.write({});
}

void HostTool::begin_with(const std::vector<YieldedRow>& rows) {
  begin_yielded(rows, state_);
  reset();
}

HostTick HostTool::latest() noexcept {
  static_cast<void>(latest_.fetch());
  return latest_.latest();
}

}  // namespace palpate
