#include "runtime/inverse/inverse_link.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/device/device_turn.h"
#include "runtime/inverse/service_connection.h"
#include "runtime/usb/haply_axes.h"

namespace palpate {
namespace {

constexpr double kDelayS = 1e-3;  // assumed: the service's own exchange with the device
constexpr double kQuietS = 0.005;  // after which no late answer is expected
constexpr double kSendS = 0.005;
constexpr int kMissedMax = 10;
constexpr int kUnaskedMax = 3;  // states beyond one for a command
constexpr int kEventsMax = 16;  // that are looked at between two commands

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

InverseLink::InverseLink(InverseConfig config) : config_(std::move(config)) {
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

InverseLink::~InverseLink() {
  close();
}

DeviceLimits InverseLink::limits() const {
  return {.damping_n_s_per_m = config_.damping_n_s_per_m,
          .coulomb_n = config_.coulomb_n,
          .resolution_m = config_.resolution_m,
          .delay_s = kDelayS,
          .hold_s = kUsualHoldS,
          .force_max_n = config_.force_max_n};
}

void InverseLink::open() {
  close();
  failure_ = "";
  known_ = false;
  missed_ = 0;
  owed_ = 0;
  unasked_ = 0;
  turned_ = false;
  grip_silent_ = 0;
  sent_n_.setZero();
  static_cast<void>(id_.assign(config_.device_id));
  try {
    greet();
  } catch (const DeviceError& error) {
    close();
    throw DeviceError(fmt::format("{}: {}", config_.what, error.what()));
  }
}

void InverseLink::greet() {
  const std::string said = http_get(config_.port, "/version", config_.open_s);
  const auto version = inverse_version(said);
  if (!version || force_key(*version) == nullptr) {
    throw DeviceError(
        fmt::format("version of the service is {}, must be 3.1 or later",
                    version ? fmt::format("{}.{}", version->major, version->minor)
                            : "not to be read from what it says"));
  }
  key_ = force_key(*version);
  // Before the first force, so that no event is missed.
  events_ = std::make_unique<InverseSocket>(config_.events_port, config_.open_s);
  states_ = std::make_unique<InverseSocket>(config_.port, config_.open_s);
  const InverseState state = first_state();
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
  if (exchange(Eigen::Vector3d::Zero(), config_.profile) != LinkStatus::kOk) {
    throw DeviceError(*failure_ != '\0' ? failure_ : "does not answer a first command");
  }
  tell_filters(state.device);
}

// The service speaks first.
InverseState InverseLink::first_state() {
  std::string_view text;
  if (states_->receive(text, inverse_deadline_ns(config_.open_s)) !=
      SocketRead::kMessage) {
    throw DeviceError(states_->failure() != nullptr
                          ? states_->failure()
                          : "the service does not say what devices it has");
  }
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
void InverseLink::choose_grip(const InverseState& state) {
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

void InverseLink::tell_filters(const InverseDevice& device) const {
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

// The last message of a session that still takes any is zero force; then it ends, and
// whatever it had asked for.
LinkStatus InverseLink::give_up(const char* why) noexcept {
  sent_n_.setZero();
  if (*failure_ == '\0') {
    failure_ = why;
    static_cast<void>(send(Eigen::Vector3d::Zero(), ""));
    states_->send_close();
    states_.reset();
    events_.reset();
  }
  return LinkStatus::kLost;
}

bool InverseLink::send(const Eigen::Vector3d& force_n,
                       std::string_view profile) noexcept {
  const std::size_t size =
      write_inverse_command(command_, id_.view(), key_, to_haply(force_n), profile);
  return states_->send({command_.data(), size}, inverse_deadline_ns(kSendS));
}

// Null if it is a state of the device, and the device is as it should be.
const char* InverseLink::take_state(std::string_view text) noexcept {
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

const char* InverseLink::take_turn(const InverseGrip& grip) noexcept {
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

// Null if it is a state as take_state() has it, and one of a command.
const char* InverseLink::take_answer(std::string_view text) noexcept {
  if (const char* why = take_state(text)) {
    return why;
  }
  unasked_ += owed_ == 0 ? 1 : 0;
  owed_ -= owed_ > 0 ? 1 : 0;
  return unasked_ > kUnaskedMax ? "sends states that nobody asked for" : nullptr;
}

// What lies there before a command: answers that came late, and states that nobody
// asked for. Null if these are not too many.
const char* InverseLink::take_waiting() noexcept {
  std::string_view text;
  for (;;) {
    const SocketRead read = states_->receive(text, 0);
    if (read == SocketRead::kNothing) {
      return nullptr;
    }
    const char* why =
        read == SocketRead::kLost ? states_->failure() : take_answer(text);
    if (why != nullptr) {
      return why;
    }
  }
}

LinkStatus InverseLink::exchange(const Eigen::Vector3d& force_n,
                                 std::string_view profile) noexcept {
  if (const char* why = take_waiting()) {
    return give_up(why);
  }
  if (!send(force_n, profile)) {
    return give_up(states_->failure());
  }
  owed_ = std::min(owed_ + 1, kMissedMax + 1);
  std::int64_t deadline_ns = inverse_deadline_ns(config_.answer_s);
  bool answered = false;
  for (;;) {
    std::string_view text;
    switch (states_->receive(text, deadline_ns)) {
      case SocketRead::kLost:
        return give_up(states_->failure());
      case SocketRead::kMessage:
        if (const char* why = take_answer(text)) {
          return give_up(why);
        }
        answered = true;
        // Those that answer missed commands come first; the last one counts.
        deadline_ns = inverse_deadline_ns(missed_ > 0 ? kQuietS : 0.0);
        break;
      case SocketRead::kNothing:
        if (answered) {
          missed_ = 0;
          return LinkStatus::kOk;
        }
        return ++missed_ > kMissedMax ? give_up("answers no commands any more")
                                      : LinkStatus::kMissed;
    }
  }
}

const char* InverseLink::heard_fault() noexcept {
  for (int i = 0; i < kEventsMax; ++i) {
    std::string_view text;
    const SocketRead read = events_->receive(text, 0);
    if (read == SocketRead::kNothing) {
      return nullptr;
    }
    InverseEvent event;
    if (read == SocketRead::kLost) {
      return "its events end: the service has stopped";
    }
    if (const char* why = scan_inverse_event(text, event)) {
      return why;
    }
    if (const char* why = fault_of(event, id_.view())) {
      return why;
    }
  }
  return nullptr;
}

LinkStatus InverseLink::transact(const Eigen::Vector3d& force_n,
                                 Eigen::Vector3d& position_m) noexcept {
  if (states_ == nullptr) {  // not open, or lost
    return LinkStatus::kLost;
  }
  if (const char* why = heard_fault()) {
    return give_up(why);
  }
  sent_n_.setZero();
  if (known_ && force_n.allFinite()) {
    const double length = force_n.norm();
    sent_n_ =
        force_n * (length > config_.force_max_n ? config_.force_max_n / length : 1.0);
  }
  const LinkStatus status = exchange(sent_n_, "");
  known_ = status == LinkStatus::kOk;
  if (known_) {
    position_m = position_m_;
  }
  return status;
}

void InverseLink::close() noexcept {
  if (states_ != nullptr &&
      exchange(Eigen::Vector3d::Zero(), "") != LinkStatus::kLost) {
    states_->send_close();
  }
  states_.reset();
  events_.reset();
  known_ = false;
}

}  // namespace palpate
