#include "runtime/inverse/inverse_message.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "runtime/inverse/json_cursor.h"

namespace palpate {
namespace {

// A field that is there twice could mean either.
template <typename Value>
void set_once(JsonCursor& json, std::optional<Value>& field, const Value& value) {
  if (field) {
    json.fail("a field that is there twice");
  }
  field = value;
}

// The numbers of an object by one letter each, from `first` on in the alphabet.
template <int kParts>
std::optional<Eigen::Vector<double, kParts>> parts(JsonCursor& json, char first,
                                                   const char* missing) {
  std::array<std::optional<double>, kParts> part;
  json.object([&](std::string_view name) {
    const bool known = name.size() == 1 && name[0] >= first && name[0] <= 'z';
    if (known) {
      set_once(json, part[static_cast<std::size_t>(name[0] - first)], json.number());
    } else {
      json.skip();
    }
  });
  Eigen::Vector<double, kParts> value;
  for (std::size_t i = 0; i < kParts; ++i) {
    if (!part[i]) {
      json.fail(missing);
      return std::nullopt;
    }
    value[static_cast<Eigen::Index>(i)] = *part[i];
  }
  return value;
}

Eigen::Vector3d vector(JsonCursor& json) {
  const Eigen::Vector3d value = parts<3>(json, 'x', "a position without x, y or z")
                                    .value_or(Eigen::Vector3d::Zero());
  if (!(value.cwiseAbs().maxCoeff() <= kInversePositionMaxM)) {
    json.fail("a position that cannot be");
  }
  return value;
}

Eigen::Quaterniond orientation(JsonCursor& json) {
  const Eigen::Vector4d wxyz =
      parts<4>(json, 'w', "an orientation without w, x, y or z")
          .value_or(Eigen::Vector4d::Zero());
  return {wxyz[0], wxyz[1], wxyz[2], wxyz[3]};
}

void scan_state(JsonCursor& json, InverseDevice& device) {
  json.object([&](std::string_view name) {
    if (name == "cursor_position") {
      set_once(json, device.position_m, vector(json));
    } else {
      json.skip();
    }
  });
}

void scan_status(JsonCursor& json, InverseDevice& device) {
  json.object([&](std::string_view name) {
    std::optional<bool>* const field = name == "ready"          ? &device.ready
                                       : name == "calibrated"   ? &device.calibrated
                                       : name == "in_use"       ? &device.in_use
                                       : name == "power_supply" ? &device.power_supply
                                                                : nullptr;
    if (field != nullptr) {
      set_once(json, *field, json.boolean());
    } else {
      json.skip();
    }
  });
}

// {"name": value}, and whatever else is in the object.
template <typename Take>
void scan_only(JsonCursor& json, std::string_view wanted, const Take& take) {
  json.object([&](std::string_view name) {
    if (name == wanted) {
      take();
    } else {
      json.skip();
    }
  });
}

void scan_filters(JsonCursor& json, InverseDevice& device) {
  json.object([&](std::string_view name) {
    if (name == "force_gate") {
      scan_only(json, "gain", [&] {
        set_once(json, device.force_gate, json.number());
      });
    } else if (name == "damping") {
      scan_only(json, "scalar", [&] {
        set_once(json, device.damping, json.number());
      });
    } else {
      json.skip();
    }
  });
}

void scan_config(JsonCursor& json, InverseDevice& device) {
  json.object([&](std::string_view name) {
    if (name == "gravity_compensation") {
      scan_only(json, "enabled", [&] {
        set_once(json, device.gravity_compensated, json.boolean());
      });
    } else if (name == "filters") {
      scan_filters(json, device);
    } else {
      json.skip();
    }
  });
}

void scan_id(JsonCursor& json, ShortText& id) {
  if (!id.view().empty() || !id.assign(json.string()) || id.view().empty()) {
    json.fail("a device's name that cannot be one");
  }
}

void scan_grip(JsonCursor& json, InverseGrip& grip) {
  json.object([&](std::string_view name) {
    if (name == "device_id") {
      scan_id(json, grip.id);
    } else if (name == "state") {
      scan_only(json, "orientation", [&] {
        set_once(json, grip.orientation, orientation(json));
      });
    } else {
      json.skip();
    }
  });
  if (grip.id.view().empty()) {
    json.fail("a grip without a name");
  }
}

void scan_device(JsonCursor& json, InverseDevice& device) {
  json.object([&](std::string_view name) {
    if (name == "device_id") {
      scan_id(json, device.id);
    } else if (name == "state") {
      scan_state(json, device);
    } else if (name == "status") {
      scan_status(json, device);
    } else if (name == "config") {
      scan_config(json, device);
    } else {
      json.skip();
    }
  });
  if (device.id.view().empty()) {
    json.fail("a device without a name");
  }
}

void scan_devices(JsonCursor& json, std::string_view id, InverseState& state) {
  json.array([&] {
    InverseDevice device;
    scan_device(json, device);
    ++state.devices;
    const bool meant = id.empty() ? state.devices == 1 : device.id.view() == id;
    if (meant && state.found) {
      json.fail("two devices of one name");
    }
    if (meant) {
      state.found = true;
      state.device = device;
    }
  });
}

void scan_grips(JsonCursor& json, std::string_view id, InverseState& state) {
  json.array([&] {
    InverseGrip grip;
    scan_grip(json, grip);
    ++state.grips;
    if (id.empty() ? state.grips == 1 : grip.id.view() == id) {
      if (!state.grip.id.view().empty()) {
        json.fail("two grips of one name");
      }
      state.grip = grip;
    }
  });
}

}  // namespace

bool ShortText::assign(std::string_view text) noexcept {
  const bool good =
      text.size() <= kBytes && std::all_of(text.begin(), text.end(), [](char c) {
        return c >= 0x20 && c < 0x7F && c != '"' && c != '\\';
      });
  size_ = good ? text.size() : 0;
  std::copy_n(text.begin(), size_, bytes_.begin());
  return good;
}

const char* scan_inverse_state(std::string_view text, std::string_view id,
                               InverseState& state, std::string_view grip_id) noexcept {
  state = {};
  if (text.size() > kInverseMessageBytes) {
    return "a message of more than 64 KiB";
  }
  JsonCursor json(text);
  // {"inverse3": [device ...], "verse_grip": [grip ...], "wireless_verse_grip": [grip
  // ...]}, other fields passed over. Grips by wire and without are one list.
  constexpr std::array<std::string_view, 3> kLists{"inverse3", "verse_grip",
                                                   "wireless_verse_grip"};
  std::array<bool, kLists.size()> listed{};
  json.object([&](std::string_view name) {
    const auto list = std::find(kLists.begin(), kLists.end(), name);
    if (list == kLists.end()) {
      json.skip();
      return;
    }
    if (std::exchange(listed[static_cast<std::size_t>(list - kLists.begin())], true)) {
      json.fail("a field that is there twice");
    }
    if (list == kLists.begin()) {
      scan_devices(json, id, state);
    } else {
      scan_grips(json, grip_id, state);
    }
  });
  json.end();
  return json.failure();
}

const char* scan_inverse_event(std::string_view text, InverseEvent& event) noexcept {
  event = {};
  if (text.size() > kInverseMessageBytes) {
    return "a message of more than 64 KiB";
  }
  JsonCursor json(text);
  const auto take = [&json](ShortText& field) {
    // A text that is too long is none of those that mean something.
    static_cast<void>(field.assign(json.string()));
  };
  json.object([&](std::string_view name) {
    if (name == "name") {
      take(event.name);
    } else if (name == "level") {
      take(event.level);
    } else if (name == "data") {
      json.object([&](std::string_view inner) {
        if (inner == "device_id") {
          take(event.device_id);
        } else if (inner == "safety_type") {
          take(event.safety_type);
        } else {
          json.skip();
        }
      });
    } else {
      json.skip();
    }
  });
  json.end();
  return json.failure();
}

const char* fault_of(const InverseEvent& event, std::string_view id) noexcept {
  const std::string_view name = event.name.view();
  // An event that names no device counts for each.
  if (!event.device_id.view().empty() && event.device_id.view() != id) {
    return nullptr;
  }
  if (name == "device-disconnected") {
    return "unplugged: the service says that the device is gone";
  }
  if (name == "device-busy") {
    return "busy: another session uses the device";
  }
  if (name == "device-connection-loop") {
    return "its cable connects and disconnects again and again";
  }
  if (name != "device-safety-triggered") {
    return nullptr;
  }
  const std::string_view type = event.safety_type.view();
  if (type == "ebrake_triggered") {
    return "its emergency brake is on";
  }
  if (type == "stall_detected") {
    return "its safety was triggered: a motor stalls";
  }
  if (type == "stability_ceiling") {
    return "its safety was triggered: stability ceiling";
  }
  // Safety of another type is a fault unless its level is low.
  const std::string_view level = event.level.view();
  return level == "info" || level == "notice" ? nullptr : "its safety was triggered";
}

std::optional<InverseVersion> inverse_version(std::string_view text) noexcept {
  const auto is_digit = [](char c) {
    return c >= '0' && c <= '9';
  };
  const char* const end = text.data() + text.size();
  for (const char* at = text.data(); at != end; ++at) {
    if (!is_digit(*at)) {
      continue;
    }
    InverseVersion version;
    const auto [point, bad] = std::from_chars(at, end, version.major);
    if (bad == std::errc() && point != end && *point == '.' &&
        std::from_chars(point + 1, end, version.minor).ec == std::errc() &&
        version.minor >= 0) {
      return version;
    }
    at = std::find_if_not(at, end, is_digit) - 1;
  }
  return std::nullopt;
}

const char* force_key(const InverseVersion& version) noexcept {
  if (version.major < 3 || (version.major == 3 && version.minor < 1)) {
    return nullptr;
  }
  return version.major == 3 && version.minor < 5 ? "values" : "vector";
}

bool is_profile_name(std::string_view name) noexcept {
  constexpr std::string_view kAllowed =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._:-";
  return !name.empty() && name.size() <= 64 &&
         name.find_first_not_of(kAllowed) == std::string_view::npos;
}

std::size_t write_inverse_command(std::span<char> into, std::string_view id,
                                  const char* key, const Eigen::Vector3d& force_n,
                                  std::string_view profile) noexcept {
  constexpr int kDigits = 9;
  char* at = into.data();
  char* const end = at + into.size();
  const auto put = [&at](std::string_view text) {
    at = std::copy(text.begin(), text.end(), at);
  };
  // {"session": ..., "inverse3": [{"device_id": ID, "commands": {"set_cursor_force":
  // {KEY: {"x": FX, "y": FY, "z": FZ}}}}]}, forces in N with nine digits.
  put("{");
  if (!profile.empty()) {
    put(R"("session":{"configure":{"profile":{"name":")");
    put(profile);
    put(R"("}}},)");
  }
  put(R"("inverse3":[{"device_id":")");
  put(id);
  put(R"(","commands":{"set_cursor_force":{")");
  put(key);
  for (const auto& [before, value] :
       {std::pair(R"(":{"x":)", force_n.x()), std::pair(R"(,"y":)", force_n.y()),
        std::pair(R"(,"z":)", force_n.z())}) {
    put(before);
    at = std::to_chars(at, end, value, std::chars_format::general, kDigits).ptr;
  }
  put("}}}}]}");
  return static_cast<std::size_t>(at - into.data());
}

}  // namespace palpate
