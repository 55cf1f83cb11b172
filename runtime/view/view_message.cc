#include "runtime/view/view_message.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"

namespace palpate {
namespace {

using Json = nlohmann::json;

// Keys are counted by the parser's own object, which keeps one of each name.
void check_keys(const Json& message, std::initializer_list<std::string_view> allowed) {
  for (const auto& [key, value] : message.items()) {
    if (std::find(allowed.begin(), allowed.end(), key) == allowed.end()) {
      throw InputError("message has a key that its type does not know");
    }
  }
}

const Json& value(const Json& message, const char* key) {
  const auto found = message.find(key);
  if (found == message.end()) {
    throw InputError(fmt::format("message lacks \"{}\"", key));
  }
  return *found;
}

std::string text(const Json& message, const char* key) {
  const Json& found = value(message, key);
  if (!found.is_string()) {
    throw InputError(fmt::format("\"{}\" must be a string", key));
  }
  return found.get<std::string>();
}

double number(const Json& found, const char* what, double low, double high) {
  const double x = found.is_number() ? found.get<double>()
                                     : std::numeric_limits<double>::quiet_NaN();
  if (!(x >= low && x <= high)) {
    throw InputError(
        fmt::format("\"{}\" must be a number in [{}, {}]", what, low, high));
  }
  return x;
}

bool truth(const Json& found, const char* what) {
  if (!found.is_boolean()) {
    throw InputError(fmt::format("\"{}\" must be true or false", what));
  }
  return found.get<bool>();
}

// @param count spelled out.
void take_numbers(const Json& found, const char* what, const char* count, double most,
                  Eigen::Ref<Eigen::VectorXd> into) {
  if (!found.is_array() || found.size() != static_cast<std::size_t>(into.size())) {
    throw InputError(fmt::format("\"{}\" must be {} numbers", what, count));
  }
  for (Eigen::Index i = 0; i < into.size(); ++i) {
    into(i) = number(found[static_cast<std::size_t>(i)], what, -most, most);
  }
}

Eigen::Quaterniond turn(const Json& found) {
  Eigen::Vector4d xyzw;
  take_numbers(found, "turn", "four", 1.0, xyzw);
  if (!(xyzw.norm() >= ViewRanges::kQuaternionMin)) {
    throw InputError(fmt::format("\"turn\" must be a quaternion at least {} long",
                                 ViewRanges::kQuaternionMin));
  }
  return Eigen::Quaterniond(xyzw).normalized();
}

ViewRequest point(const Json& message) {
  ViewRequest request;
  request.hold = truth(value(message, "hold"), "hold");
  if (message.contains("hand")) {
    const Json& hand = message["hand"];
    if (!hand.is_number_integer()) {
      throw InputError("\"hand\" must be 0 or 1");
    }
    request.hand = static_cast<int>(number(hand, "hand", 0.0, 1.0));
  }
  if (!request.hold) {
    check_keys(message, {"type", "hold", "hand"});
    return request;
  }
  check_keys(message, {"type", "hold", "hand", "target_m", "turn"});
  take_numbers(value(message, "target_m"), "target_m", "three", ViewRanges::kTargetM,
               request.target_m);
  if (message.contains("turn")) {
    request.turn = turn(message["turn"]);
  }
  return request;
}

void set_friction(const Json& found, ViewRequest& request) {
  if (found.is_null()) {
    request.database_friction = true;
  } else {
    request.friction = number(found, "friction", 0.0, ViewRanges::kFrictionMax);
  }
}

ViewRequest set(const Json& message) {
  check_keys(message,
             {"type", "model", "slow_hz", "stiffness_scale", "friction", "coupled"});
  ViewRequest request{.action = ViewAction::kSet};
  if (message.contains("model")) {
    request.model = local_model(text(message, "model"));
    if (!request.model) {
      throw InputError("\"model\" must name a local model");
    }
  }
  if (message.contains("slow_hz")) {
    request.slow_hz = number(message["slow_hz"], "slow_hz", ViewRanges::kSlowHzMin,
                             ViewRanges::kSlowHzMax);
  }
  if (message.contains("stiffness_scale")) {
    request.stiffness_scale =
        number(message["stiffness_scale"], "stiffness_scale", ViewRanges::kStiffnessMin,
               ViewRanges::kStiffnessMax);
  }
  if (message.contains("friction")) {
    set_friction(message["friction"], request);
  }
  if (message.contains("coupled")) {
    request.coupled = truth(message["coupled"], "coupled");
  }
  if (message.size() == 1) {
    throw InputError("message sets nothing");
  }
  return request;
}

ViewRequest run(const Json& message) {
  check_keys(message, {"type", "do"});
  const std::string what = text(message, "do");
  ViewRequest request;
  if (what == "pause") {
    request.action = ViewAction::kPause;
  } else if (what == "resume") {
    request.action = ViewAction::kResume;
  } else if (what == "step") {
    request.action = ViewAction::kStep;
  } else if (what == "reset") {
    request.action = ViewAction::kReset;
  } else if (what == "record") {
    request.action = ViewAction::kRecord;
  } else if (what == "replay") {
    request.action = ViewAction::kReplay;
  } else if (what == "anew") {
    request.action = ViewAction::kAnew;
  } else {
    throw InputError(
        "\"do\" must be pause, resume, step, reset, record, replay or anew");
  }
  return request;
}

std::int32_t node_number(const Json& found) {
  if (!found.is_number_integer()) {
    throw InputError("\"node\" must be a whole number");
  }
  constexpr double kMost = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(number(found, "node", 0.0, kMost));
}

ViewRequest node(const Json& message, ViewAction action) {
  check_keys(message, {"type", "node"});
  ViewRequest request{.action = action};
  request.node = node_number(value(message, "node"));
  return request;
}

ViewRequest device(const Json& message) {
  const std::string what = text(message, "do");
  ViewRequest request{.action = what == "on"     ? ViewAction::kDevice
                                : what == "keep" ? ViewAction::kDeviceKept
                                                 : ViewAction::kDeviceOff};
  if (request.action != ViewAction::kDevice) {
    check_keys(message, {"type", "do"});
    if (what != "keep" && what != "off") {
      throw InputError("\"do\" must be on, keep or off");
    }
    return request;
  }
  check_keys(message, {"type", "do", "node", "right", "limit"});
  request.node = node_number(value(message, "node"));
  take_numbers(value(message, "right"), "right", "three", ViewRanges::kDirectionMost,
               request.right);
  request.limit = truth(value(message, "limit"), "limit");
  return request;
}

}  // namespace

ViewRequest decode_view_message(std::string_view text_in) {
  if (text_in.size() > kViewMessageBytes) {
    throw InputError(fmt::format("message has {} bytes, at most {} are allowed",
                                 text_in.size(), kViewMessageBytes));
  }
  const Json message = parse_json(text_in);
  if (!message.is_object()) {
    throw InputError("message is not a JSON object");
  }
  const std::string type = text(message, "type");
  if (type == "point") {
    return point(message);
  }
  if (type == "set") {
    return set(message);
  }
  if (type == "run") {
    return run(message);
  }
  if (type == "device") {
    return device(message);
  }
  if (type == "node") {
    return node(message, ViewAction::kNode);
  }
  if (type == "field") {
    return node(message, ViewAction::kField);
  }
  throw InputError("\"type\" must be point, set, run, device, node or field");
}

}  // namespace palpate
