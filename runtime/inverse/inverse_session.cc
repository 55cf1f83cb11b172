#include "runtime/inverse/inverse_session.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/device/device_turn.h"
#include "runtime/usb/haply_axes.h"

namespace palpate {
namespace {

constexpr double kDelayS = 1e-3;  // assumed: the service's own exchange with the device
constexpr int kMissedMax = 10;
constexpr int kUnaskedMax = 3;  // states beyond one for a command

// Between our axes and the grip's own, which is all that TurnFromStart needs.
Eigen::Quaterniond to_ours(const Eigen::Quaterniond& turn) noexcept {
  Eigen::Quaterniond ours;
  ours.w() = turn.w();
  ours.vec() = from_haply(turn.vec());
  return ours;
}

// What keeps forces from a device; null if nothing does.
const char* why_not(const InverseDevice& device) {
  if (device.ready == false) {
    return "not ready: the service says so";
  }
  if (device.calibrated == false) {
    return "not calibrated: put its arm where the service asks for it";
  }
  if (device.power_supply == false) {
    return "has no power supply: its motors cannot push";
  }
  return nullptr;
}

}  // namespace

DeviceLimits inverse_limits(const InverseConfig& config) {
  return {.damping_n_s_per_m = config.damping_n_s_per_m,
          .coulomb_n = config.coulomb_n,
          .resolution_m = config.resolution_m,
          .delay_s = kDelayS,
          .hold_s = kUsualHoldS,
          .force_max_n = config.force_max_n};
}

InverseSession::InverseSession(InverseConfig config) : config_(std::move(config)) {
  if (!is_profile_name(config_.profile)) {
    throw InputError(fmt::format(
        "profile \"{}\": must be 1 to 64 letters, digits and ._:-", config_.profile));
  }
  if (!id_.assign(config_.device_id)) {
    throw InputError(fmt::format("device id \"{}\" cannot be one", config_.device_id));
  }
  if (!grip_.assign(config_.grip_id)) {
    throw InputError(fmt::format("grip id \"{}\" cannot be one", config_.grip_id));
  }
}

void InverseSession::greet(std::string_view text, const char* key) {
  const InverseState state = first_state(text);
  key_ = key;
  id_ = state.device.id;
  if (state.device.in_use == true) {
    throw DeviceError(
        fmt::format("device {} is in use by another session: their forces would add up",
                    id_.view()));
  }
  if (const char* why = why_not(state.device)) {
    throw DeviceError(fmt::format("device {}: {}", id_.view(), why));
  }
  choose_grip(state);
  tell_filters(state.device);
}

InverseState InverseSession::first_state(std::string_view text) const {
  InverseState state;
  if (const char* why =
          scan_inverse_state(text, config_.device_id, state, config_.grip_id)) {
    throw DeviceError(fmt::format("its first message was refused: {}", why));
  }
  if (!state.found) {
    throw DeviceError(config_.device_id.empty()
                          ? "the service has no device: is it plugged in?"
                          : fmt::format("the service has no device {}, but {} other",
                                        config_.device_id, state.devices));
  }
  if (config_.device_id.empty() && state.devices > 1) {
    throw DeviceError(
        fmt::format("the service has {} devices, the first is {}: name one by "
                    "--device-id",
                    state.devices, state.device.id.view()));
  }
  return state;
}

// Several that nobody chose between turn nothing: a tool of one contact needs none.
void InverseSession::choose_grip(const InverseState& state) {
  const auto turn =
      state.grip.orientation ? exact_turn(*state.grip.orientation) : std::nullopt;
  if (!config_.grip_id.empty() && !turn) {
    throw DeviceError(
        fmt::format("the service has no grip {} that says how it is "
                    "turned; it has {} grips",
                    config_.grip_id, state.grips));
  }
  const bool chosen = !config_.grip_id.empty() || state.grips == 1;
  turned_ = chosen && turn.has_value();
  if (turned_) {
    grip_ = state.grip.id;
    turn_ = to_ours(*turn);
  }
  if (config_.tell && turned_) {
    config_.tell(fmt::format(
        "{}: grip {} turns tools of several contacts; as it is held when the run "
        "begins they are upright; torque is not felt",
        config_.what, grip_.view()));
  } else if (config_.tell && !chosen && state.grips > 1) {
    config_.tell(fmt::format(
        "{}: the service has {} grips, none of them turns the tool: name one by "
        "--grip-id",
        config_.what, state.grips));
  }
}

void InverseSession::tell_filters(const InverseDevice& device) const {
  if (!config_.tell) {
    return;
  }
  std::string filters;
  if (device.gravity_compensated == true) {
    filters += ", gravity compensation on";
  }
  if (device.force_gate.value_or(0.0) != 0.0) {
    filters += fmt::format(", force gate with gain {:g}", *device.force_gate);
  }
  if (device.damping.value_or(0.0) != 0.0) {
    filters += fmt::format(", damping {:g}", *device.damping);
  }
  config_.tell(fmt::format(
      "{}: device {}{}{}", config_.what, id_.view(), filters,
      filters.empty() ? ""
                      : ": the service alters forces by them, and the account of "
                        "energy does not know it"));
}

std::string_view InverseSession::command(const Eigen::Vector3d& force_n,
                                         std::string_view profile) noexcept {
  sent_n_.setZero();
  if (known_ && force_n.allFinite()) {
    const double length = force_n.norm();
    sent_n_ =
        force_n * (length > config_.force_max_n ? config_.force_max_n / length : 1.0);
  }
  owed_ = std::min(owed_ + 1, kMissedMax + 1);
  return {command_.data(), write_inverse_command(command_, id_.view(), key_,
                                                 to_haply(sent_n_), profile)};
}

const char* InverseSession::take(std::string_view text) noexcept {
  if (const char* why = take_state(text)) {
    return why;
  }
  if (owed_ == 0) {
    return take_unasked();
  }
  --owed_;
  return nullptr;
}

const char* InverseSession::take_unasked() noexcept {
  return ++unasked_ > kUnaskedMax ? "sends states that nobody asked for" : nullptr;
}

const char* InverseSession::exchanged(bool in_time) noexcept {
  known_ = in_time && std::exchange(begun_, begun_ || in_time);
  missed_ = in_time ? 0 : missed_ + 1;
  return missed_ > kMissedMax ? "answers no commands any more" : nullptr;
}

const char* InverseSession::take_event(std::string_view text) const noexcept {
  InverseEvent event;
  const char* const why = scan_inverse_event(text, event);
  return why != nullptr ? why : fault_of(event, id_.view());
}

// Null if it is a state of the device, and the device is as it should be.
const char* InverseSession::take_state(std::string_view text) noexcept {
  InverseState state;
  if (const char* why = scan_inverse_state(text, id_.view(), state, grip_.view())) {
    return why;
  }
  if (!state.found) {
    return "unplugged: the service has the device no more";
  }
  if (const char* why = why_not(state.device)) {
    return why;
  }
  if (!state.device.position_m) {
    return "a state without a position";
  }
  if (const char* why = turned_ ? take_turn(state.grip) : nullptr) {
    return why;
  }
  position_m_ = from_haply(*state.device.position_m);
  return nullptr;
}

const char* InverseSession::take_turn(const InverseGrip& grip) noexcept {
  if (!grip.orientation) {
    return ++grip_silent_ < kGripSilentMax
               ? nullptr
               : "its grip is gone: nobody says how it is turned";
  }
  grip_silent_ = 0;
  const auto turn = exact_turn(*grip.orientation);
  if (!turn) {
    return "its grip says an orientation that is none";
  }
  turn_ = to_ours(*turn);
  return nullptr;
}

}  // namespace palpate
