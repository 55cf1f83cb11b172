#include "runtime/inverse/emulated_inverse.h"

#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/eventfd.h>

#include "formats/base/json_text.h"
#include "runtime/inverse/emulated_inverse_parts.h"
#include "runtime/inverse/inverse_message.h"
#include "runtime/realtime/real_time.h"
#include "runtime/usb/haply_axes.h"

namespace palpate {

using Json = nlohmann::json;

namespace {

Json as_json(const Eigen::Vector3d& v) {
  return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}};
}

}  // namespace

EmulatedInverse::Parts::Parts(const EmulatedInverseConfig& wanted)
    : config(wanted),
      tool(config.dynamics, config.hand, clock, {.position_m = config.start_m}) {
  key = force_key(inverse_version(config.version).value_or(InverseVersion{3, 5}));
  key = key == nullptr ? "values" : key;
  tool.open();
}

std::string EmulatedInverse::Parts::version() const {
  return json_text(Json{{"version", config.version}});
}

std::string EmulatedInverse::Parts::first_message() {
  const std::lock_guard lock(mutex);
  Json all = state(true);
  all["session_id"] = 7;
  return json_text(all);
}

std::string EmulatedInverse::Parts::answer() {
  const std::lock_guard lock(mutex);
  return json_text(state(false));
}

// @param whole with what is said once.
Json EmulatedInverse::Parts::state(bool whole) {
  DeviceReading at;
  static_cast<void>(tool.read(at));
  Json devices = Json::array();
  for (int i = 0; i < config.devices; ++i) {
    Json device = {
        {"device_id", i == 0 ? config.device_id : fmt::format("{:04X}", i)},
        {"state",
         {{"cursor_velocity", as_json(to_haply(tool.motion().velocity_m_per_s))},
          {"angular_position", {{"a0", 0.0}, {"a1", 0.0}, {"a2", 0.0}}},
          {"body_orientation", {{"w", 1.0}, {"x", 0.0}, {"y", 0.0}, {"z", 0.0}}},
          {"current_cursor_force", as_json(to_haply(tool.acting_force_n()))},
          {"control_domain", "cartesian"},
          {"control_mode", "force"}}},
        {"status",
         {{"calibrated", !is_faulty(InverseFault::kNotCalibrated)},
          {"in_use", config.in_use},
          {"power_supply", !is_faulty(InverseFault::kNoPower)},
          {"ready", !is_faulty(InverseFault::kNotReady)},
          {"started", true}}}};
    if (!is_faulty(InverseFault::kNoPosition)) {
      device["state"]["cursor_position"] = as_json(to_haply(at.position_m));
    }
    if (whole) {
      device["config"] = {
          {"type", "inverse3"},
          {"gravity_compensation",
           {{"enabled", config.gravity_compensated}, {"scaling_factor", 1.0}}},
          {"handedness", "right"},
          {"filters",
           {{"force_gate", {{"gain", config.force_gate}}},
            {"damping", {{"scalar", 0.0}}}}}};
    }
    devices.push_back(std::move(device));
  }
  if (is_faulty(InverseFault::kUnplugged) || is_faulty(InverseFault::kSilentUnplug)) {
    devices.clear();
  }
  return {{"inverse3", devices}, {"wireless_verse_grip", grips()}};
}

// With a heading of its own, as an inertial sensor has; rounded as single precision.
Json EmulatedInverse::Parts::grips() {
  const auto heading = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ());
  const double time_s = message == 0 ? 0.0
                                     : static_cast<double>(clock.now_ns() - first_ns) /
                                           kNanosecondsPerSecond;
  const Eigen::Quaterniond ours =
      config.grip_turn ? config.grip_turn(time_s) : config.grip.at(time_s);
  Eigen::Quaterniond turn;
  turn.w() = ours.w();
  turn.vec() = to_haply(ours.vec());
  turn = turn * heading;
  if (is_faulty(InverseFault::kNoTurn)) {
    turn.coeffs().setZero();
  }
  Json list = Json::array();
  for (int i = 0; i < config.grips && !is_faulty(InverseFault::kNoGrip); ++i) {
    const Eigen::Vector4f wxyz =
        Eigen::Vector4d(turn.w(), turn.x(), turn.y(), turn.z()).cast<float>();
    list.push_back(
        {{"device_id", std::to_string(61576 + i)},
         {"state",
          {{"orientation",
            {{"w", wxyz[0]}, {"x", wxyz[1]}, {"y", wxyz[2]}, {"z", wxyz[3]}}},
           {"buttons", {{"a", false}, {"b", false}, {"c", false}}}}}});
  }
  return list;
}

// A command of another spelling is no command; the force ends where none comes.
void EmulatedInverse::Parts::obey(const std::string& text) {
  const std::lock_guard lock(mutex);
  if (++message == 1) {
    tool.open();  // the hand begins
    first_ns = clock.now_ns();
  }
  std::optional<Eigen::Vector3d> force_n;
  try {
    const Json said = parse_json(text);
    if (said.contains("session")) {
      profile = said["session"]["configure"]["profile"]["name"].get<std::string>();
    }
    const Json& device = said.at("inverse3").at(0);
    const Json& command = device.at("commands").at("set_cursor_force");
    if (device.at("device_id") == config.device_id && command.contains(key)) {
      const Json& vector = command[key];
      force_n = from_haply({vector.at("x").get<double>(), vector.at("y").get<double>(),
                            vector.at("z").get<double>()});
    } else {
      refused = text;
    }
  } catch (const Json::exception&) {
    refused = text;
  }
  const bool gone =
      is_faulty(InverseFault::kUnplugged) || is_faulty(InverseFault::kSilentUnplug);
  if (gone || !force_n) {
    force_n = Eigen::Vector3d::Zero();
  }
  push(*force_n);
  if (!std::exchange(reported, reported || gone || is_faulty(InverseFault::kEvent))) {
    if (is_faulty(InverseFault::kUnplugged)) {
      tell(R"({"name":"device-disconnected","category":"device","level":"warning",)"
           R"("data":{"device_family":"inverse","device_id":")" +
           config.device_id + R"("},"message":"gone"})");
    } else if (is_faulty(InverseFault::kEvent)) {
      tell(config.faults.text);
    }
  }
}

void EmulatedInverse::Parts::push(const Eigen::Vector3d& force_n) {
  const bool was_pushed = tool.acting_force_n() != Eigen::Vector3d::Zero();
  static_cast<void>(tool.write(force_n));
  const std::int64_t now_ns = clock.now_ns();
  if (was_pushed && tool.acting_force_n() == Eigen::Vector3d::Zero()) {
    released_ns = now_ns;
  }
  if (trace.size() < config.trace_max) {
    trace.push_back(motor_record(tool, now_ns));
  }
  idle_due_ns = force_n == Eigen::Vector3d::Zero() ? kNever : now_ns + config.idle_ns;
}

EmulatedInverse::EmulatedInverse(const EmulatedInverseConfig& config)
    : parts_(std::make_unique<Parts>(config)) {
  parts_->trace.reserve(config.trace_max);
  parts_->listen();
  parts_->thread = std::thread([parts = parts_.get()] {
    static_cast<void>(request_real_time(-1));  // as punctual as a device, if permitted
    parts->run();
  });
}

EmulatedInverse::~EmulatedInverse() {
  static_cast<void>(::eventfd_write(parts_->wake, 1));
  parts_->thread.join();
}

std::uint16_t EmulatedInverse::port() const {
  return parts_->config.port;
}

std::uint16_t EmulatedInverse::events_port() const {
  return parts_->config.events_port;
}

Eigen::Vector3d EmulatedInverse::force_n() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->tool.acting_force_n();
}

std::int64_t EmulatedInverse::messages() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->message;
}

std::string EmulatedInverse::profile() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->profile;
}

std::string EmulatedInverse::refused() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->refused;
}

double EmulatedInverse::given_to_hand_j() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->tool.rendered_work_j() - parts_->config.dynamics.damping_n_s_per_m *
                                              parts_->tool.squared_speed_m2_per_s();
}

std::int64_t EmulatedInverse::released_ns() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->released_ns;
}

std::vector<MotorRecord> EmulatedInverse::trace() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->trace;
}

}  // namespace palpate
