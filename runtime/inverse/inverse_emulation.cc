#include "runtime/inverse/inverse_emulation.h"

#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "runtime/inverse/inverse_message.h"
#include "runtime/usb/haply_axes.h"

namespace palpate {

using Json = nlohmann::json;

namespace {

Json as_json(const Eigen::Vector3d& v) {
  return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}};
}

}  // namespace

InverseEmulation::InverseEmulation(const EmulatedInverseConfig& config, Clock& clock,
                                   std::function<void(const std::string&)> tell)
    : config_(config),
      clock_(clock),
      tell_(std::move(tell)),
      tool_(config.dynamics, config.hand, clock, {.position_m = config.start_m}) {
  key_ = force_key(inverse_version(config_.version).value_or(InverseVersion{3, 5}));
  key_ = key_ == nullptr ? "values" : key_;
  trace_.reserve(config_.trace_max);
  tool_.open();
}

std::string InverseEmulation::version() const {
  return json_text(Json{{"version", config_.version}});
}

std::string InverseEmulation::first_message() {
  Json all = state(true);
  all["session_id"] = 7;
  return json_text(all);
}

std::string InverseEmulation::answer() {
  return json_text(state(false));
}

// @param whole with what is said once.
Json InverseEmulation::state(bool whole) {
  DeviceReading at;
  static_cast<void>(tool_.read(at));
  Json devices = Json::array();
  for (int i = 0; i < config_.devices; ++i) {
    Json device = {
        {"device_id", i == 0 ? config_.device_id : fmt::format("{:04X}", i)},
        {"state",
         {{"cursor_velocity", as_json(to_haply(tool_.motion().velocity_m_per_s))},
          {"angular_position", {{"a0", 0.0}, {"a1", 0.0}, {"a2", 0.0}}},
          {"body_orientation", {{"w", 1.0}, {"x", 0.0}, {"y", 0.0}, {"z", 0.0}}},
          {"current_cursor_force", as_json(to_haply(tool_.acting_force_n()))},
          {"control_domain", "cartesian"},
          {"control_mode", "force"}}},
        {"status",
         {{"calibrated", !is_faulty(InverseFault::kNotCalibrated)},
          {"in_use", config_.in_use},
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
           {{"enabled", config_.gravity_compensated}, {"scaling_factor", 1.0}}},
          {"handedness", "right"},
          {"filters",
           {{"force_gate", {{"gain", config_.force_gate}}},
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
Json InverseEmulation::grips() {
  const auto heading = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ());
  const double time_s =
      message_ == 0
          ? 0.0
          : static_cast<double>(clock_.now_ns() - first_ns_) / kNanosecondsPerSecond;
  const Eigen::Quaterniond ours =
      config_.grip_turn ? config_.grip_turn(time_s) : config_.grip.at(time_s);
  Eigen::Quaterniond turn;
  turn.w() = ours.w();
  turn.vec() = to_haply(ours.vec());
  turn = turn * heading;
  if (is_faulty(InverseFault::kNoTurn)) {
    turn.coeffs().setZero();
  }
  Json list = Json::array();
  for (int i = 0; i < config_.grips && !is_faulty(InverseFault::kNoGrip); ++i) {
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

void InverseEmulation::obey(const std::string& text) {
  if (++message_ == 1) {
    tool_.open();  // the hand begins
    first_ns_ = clock_.now_ns();
  }
  std::optional<Eigen::Vector3d> force_n;
  try {
    const Json said = parse_json(text);
    if (said.contains("session")) {
      profile_ = said["session"]["configure"]["profile"]["name"].get<std::string>();
    }
    const Json& device = said.at("inverse3").at(0);
    const Json& command = device.at("commands").at("set_cursor_force");
    if (device.at("device_id") == config_.device_id && command.contains(key_)) {
      const Json& vector = command[key_];
      force_n = from_haply({vector.at("x").get<double>(), vector.at("y").get<double>(),
                            vector.at("z").get<double>()});
    } else {
      refused_ = text;
    }
  } catch (const Json::exception&) {
    refused_ = text;
  }
  const bool gone =
      is_faulty(InverseFault::kUnplugged) || is_faulty(InverseFault::kSilentUnplug);
  if (gone || !force_n) {
    force_n = Eigen::Vector3d::Zero();
  }
  push(*force_n);
  if (!std::exchange(reported_, reported_ || gone || is_faulty(InverseFault::kEvent))) {
    if (is_faulty(InverseFault::kUnplugged)) {
      tell_(R"({"name":"device-disconnected","category":"device","level":"warning",)"
            R"("data":{"device_family":"inverse","device_id":")" +
            config_.device_id + R"("},"message":"gone"})");
    } else if (is_faulty(InverseFault::kEvent)) {
      tell_(config_.faults.text);
    }
  }
}

void InverseEmulation::push(const Eigen::Vector3d& force_n) {
  const bool was_pushed = tool_.acting_force_n() != Eigen::Vector3d::Zero();
  static_cast<void>(tool_.write(force_n));
  const std::int64_t now_ns = clock_.now_ns();
  if (was_pushed && tool_.acting_force_n() == Eigen::Vector3d::Zero()) {
    released_ns_ = now_ns;
  }
  if (trace_.size() < config_.trace_max) {
    trace_.push_back(motor_record(tool_, now_ns));
  }
  idle_due_ns_ = force_n == Eigen::Vector3d::Zero() ? kNever : now_ns + config_.idle_ns;
}

double InverseEmulation::given_to_hand_j() const {
  return tool_.rendered_work_j() -
         config_.dynamics.damping_n_s_per_m * tool_.squared_speed_m2_per_s();
}

}  // namespace palpate
