// What a service may say: taken as documented, anything else refused by name.
#include "runtime/inverse/inverse_message.h"

#include <array>
#include <string>

#include <gtest/gtest.h>

#include "runtime/inverse/json_cursor.h"
#include "tests/support/allocation_guard.h"

namespace palpate {
namespace {

const std::string kWhole = R"({"session_id": 7, "inverse3": [
  {"state": {"cursor_position": {"x": 0.01, "z": 1.5e-1, "y": -0.12}, "more": [1, {}]},
   "status": {"ready": true, "in_use": false, "calibrated": true, "power_supply": true},
   "config": {"gravity_compensation": {"enabled": true, "scaling_factor": 1.0},
              "filters": {"force_gate": {"gain": 0.3}, "damping": {"scalar": 0}}},
   "device_id": "049D"},
  {"device_id": "0001", "state": {"cursor_position": {"x": 1, "y": 1, "z": 1}}}],
 "verse_grip": [], "text": "\u00e9\n\"", "null": null})";

std::string refusal(const std::string& text, const std::string& id = "") {
  InverseState state;
  const char* why = scan_inverse_state(text, id, state);
  return why == nullptr ? "" : why;
}

TEST(InverseMessage, TakesTheDeviceThatIsMeantWhateverTheOrder) {
  InverseState state;
  ASSERT_EQ(scan_inverse_state(kWhole, "049D", state), nullptr);
  EXPECT_EQ(state.devices, 2);
  EXPECT_TRUE(state.found);
  EXPECT_EQ(*state.device.position_m, Eigen::Vector3d(0.01, -0.12, 0.15));
  EXPECT_EQ(state.device.ready, true);
  EXPECT_EQ(state.device.in_use, false);
  EXPECT_EQ(state.device.gravity_compensated, true);
  EXPECT_EQ(state.device.force_gate, 0.3);
  EXPECT_EQ(state.device.damping, 0.0);
  ASSERT_EQ(scan_inverse_state(kWhole, "0001", state), nullptr);
  EXPECT_EQ(*state.device.position_m, Eigen::Vector3d(1, 1, 1));
  EXPECT_FALSE(state.device.ready.has_value());
  ASSERT_EQ(scan_inverse_state(kWhole, "", state), nullptr);
  EXPECT_EQ(state.device.id.view(), "049D");
  ASSERT_EQ(scan_inverse_state(kWhole, "FFFF", state), nullptr);
  EXPECT_FALSE(state.found);
}

TEST(InverseMessage, TakesTheGripThatIsMeantFromEitherList) {
  const auto grip = [](const std::string& id, const std::string& w) {
    return R"({"state":{"buttons":{"a":true},"orientation":{"z":0.1,"w":)" + w +
           R"(,"y":0,"x":0.5}},"device_id":")" + id + "\"}";
  };
  const std::string text = R"({"verse_grip":[)" + grip("1", "0.2") +
                           R"(],"inverse3":[],"wireless_verse_grip":[)" +
                           grip("2", "0.3") + "]}";
  InverseState state;
  ASSERT_EQ(scan_inverse_state(text, "", state, "2"), nullptr);
  EXPECT_EQ(state.grips, 2);
  EXPECT_EQ(state.grip.id.view(), "2");
  EXPECT_EQ(state.grip.orientation->coeffs(), Eigen::Vector4d(0.5, 0.0, 0.1, 0.3));
  ASSERT_EQ(scan_inverse_state(text, "", state), nullptr);
  EXPECT_EQ(state.grip.id.view(), "1");
  ASSERT_EQ(scan_inverse_state(text, "", state, "3"), nullptr);
  EXPECT_FALSE(state.grip.orientation);
  EXPECT_EQ(refusal(R"({"verse_grip":[)" + grip("1", "nan") + "]}").substr(0, 9),
            "something");
  EXPECT_EQ(refusal(R"({"verse_grip":[)" + grip("1", "1,\"w\":1") + "]}"),
            "a field that is there twice");
  EXPECT_EQ(refusal(R"({"verse_grip":[{"state":{"orientation":{"w":1}}}]})"),
            "an orientation without w, x, y or z");
  EXPECT_EQ(refusal(R"({"verse_grip":[{}]})"), "a grip without a name");
  EXPECT_EQ(refusal(R"({"verse_grip":[],"verse_grip":[]})"),
            "a field that is there twice");
}

TEST(InverseMessage, IsReadWithoutAllocation) {
  InverseState state;
  std::array<char, kInverseCommandBytes> command{};
  const test::AllocationGuard guard;
  ASSERT_EQ(scan_inverse_state(kWhole, "049D", state), nullptr);
  ASSERT_GT(write_inverse_command(command, "049D", "vector", {1e-3, -2.0, 5.0}, "a"),
            0U);
  EXPECT_EQ(guard.count(), 0U);
}

// Every beginning of a good message is a bad one.
TEST(InverseMessage, CutAnywhereIsRefused) {
  ASSERT_EQ(refusal(kWhole), "");
  for (std::size_t size = 0; size < kWhole.size(); ++size) {
    EXPECT_NE(refusal(kWhole.substr(0, size)), "") << size;
  }
  EXPECT_NE(refusal(kWhole + "x"), "");
}

TEST(InverseMessage, HostileTextIsRefusedByName) {
  const auto at = [](const std::string& x) {
    return R"({"inverse3":[{"device_id":"A","state":{"cursor_position":{"x":)" + x +
           R"(,"y":0,"z":0}}}]})";
  };
  ASSERT_EQ(refusal(at("0")), "");
  for (const char* number :
       {"nan", "NaN", "inf", "1e999", "01", "+1", ".5", "1.", "0x1", "1e", "-", "\"1\"",
        "null", "[1]", "true", "1 2", ""}) {
    EXPECT_NE(refusal(at(number)), "") << number;
  }
  EXPECT_EQ(refusal(at("2.5")), "a position that cannot be");
  EXPECT_EQ(refusal(at("-1e300")), "a position that cannot be");
  EXPECT_EQ(refusal(at("0,\"x\":1")), "a field that is there twice");
  EXPECT_EQ(refusal(R"({"inverse3":[],"inverse3":[]})"), "a field that is there twice");
  EXPECT_EQ(refusal(R"({"inverse3":[{"device_id":"A"},{"device_id":"A"}]})", "A"),
            "two devices of one name");
  EXPECT_EQ(refusal(R"({"inverse3":[{}]})"), "a device without a name");
  EXPECT_EQ(refusal(R"({"inverse3":{}})"), "something else where a list should be");
  EXPECT_EQ(refusal("[]"), "something else where an object should be");
  EXPECT_EQ(refusal("{\"a\":\"\x01\"}"), "a control character in a string");
  EXPECT_EQ(refusal(R"({"a":"\x"})"), "an escape that does not exist");
  EXPECT_EQ(refusal(R"({"a":"\u12G4"})"), "an escape that does not exist");
  EXPECT_EQ(refusal("{\"a\":\"" + std::string(kInverseMessageBytes, 'a') + "\"}"),
            "a message of more than 64 KiB");
  const std::string id(100, 'A');
  EXPECT_EQ(refusal("{\"inverse3\":[{\"device_id\":\"" + id + "\"}]}"),
            "a device's name that cannot be one");
}

TEST(InverseMessage, MayBeAsDeepAsItSaysAndNoDeeper) {
  const auto nested = [](int levels) {
    const auto n = static_cast<std::size_t>(levels - 1);
    return "{\"a\":" + std::string(n, '[') + std::string(n, ']') + "}";
  };
  EXPECT_EQ(refusal(nested(kJsonDepthMax)), "");
  EXPECT_EQ(refusal(nested(kJsonDepthMax + 1)), "more than 32 levels");
  EXPECT_EQ(refusal("{\"a\":" + std::string(60000, '[')), "more than 32 levels");
}

TEST(InverseMessage, EventsOfThisDeviceAreFaultsByName) {
  const auto fault = [](const std::string& name, const std::string& id,
                        const std::string& type, const std::string& level) {
    InverseEvent event;
    const std::string text = R"({"name":")" + name + R"(","level":")" + level +
                             R"(","data":{"device_id":")" + id +
                             R"(","safety_type":")" + type + R"("},"message":""})";
    EXPECT_EQ(scan_inverse_event(text, event), nullptr);
    const char* why = fault_of(event, "049D");
    return std::string(why == nullptr ? "" : why);
  };
  EXPECT_NE(fault("device-disconnected", "049D", "", "warning").find("unplugged"),
            std::string::npos);
  EXPECT_EQ(fault("device-disconnected", "0001", "", "warning"), "");
  EXPECT_NE(fault("device-busy", "049D", "", "warning").find("busy"),
            std::string::npos);
  EXPECT_NE(fault("device-connection-loop", "049D", "", "warning"), "");
  EXPECT_EQ(fault("device-connected", "049D", "", "info"), "");
  EXPECT_NE(fault("device-safety-triggered", "049D", "ebrake_triggered", "error")
                .find("brake"),
            std::string::npos);
  EXPECT_EQ(fault("device-safety-triggered", "049D", "ebrake_released", "notice"), "");
  EXPECT_NE(fault("device-safety-triggered", "049D", "stall_detected", "warning")
                .find("stalls"),
            std::string::npos);
  EXPECT_NE(fault("device-safety-triggered", "049D", "stability_ceiling", "warning"),
            "");
  EXPECT_NE(fault("device-safety-triggered", "049D", "fod_stage_changed", "warning"),
            "");
  EXPECT_EQ(fault("device-safety-triggered", "049D", "fod_stage_changed", "info"), "");
}

TEST(InverseMessage, TheForcesKeyFollowsTheVersion) {
  const auto key = [](const char* text) {
    const auto version = inverse_version(text);
    const char* found = version ? force_key(*version) : nullptr;
    return std::string(found == nullptr ? "none" : found);
  };
  EXPECT_EQ(key(R"({"version":"3.5.1"})"), "vector");
  EXPECT_EQ(key("v3.10"), "vector");
  EXPECT_EQ(key("4.0.0"), "vector");
  EXPECT_EQ(key("build 7, 3.4.9"), "values");
  EXPECT_EQ(key("3.1.1"), "values");
  EXPECT_EQ(key("3.0.7"), "none");
  EXPECT_EQ(key("2.9"), "none");
  EXPECT_EQ(key("7"), "none");
  EXPECT_EQ(key("99999999999999999999.1"), "none");
  EXPECT_EQ(key(""), "none");
}

TEST(InverseMessage, CommandsAreAsDocumented) {
  std::array<char, kInverseCommandBytes> into{};
  const std::size_t size = write_inverse_command(into, "049D", "vector",
                                                 {0.5, 0.0, -1.25}, "palpate:device");
  EXPECT_EQ(std::string(into.data(), size),
            R"({"session":{"configure":{"profile":{"name":"palpate:device"}}},)"
            R"("inverse3":[{"device_id":"049D","commands":{"set_cursor_force":)"
            R"({"vector":{"x":0.5,"y":0,"z":-1.25}}}}]})");
  EXPECT_FALSE(is_profile_name("a\"b"));
  EXPECT_FALSE(is_profile_name(""));
  EXPECT_FALSE(is_profile_name(std::string(65, 'a')));
}

}  // namespace
}  // namespace palpate
