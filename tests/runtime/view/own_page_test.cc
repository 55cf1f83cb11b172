// A page of its own, from a file, in a browser: what its WebAssembly feels is what this
// machine's build feels that is asked the same at the same times.
#include "tests/support/own_page.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/database/table_memory.h"
#include "formats/report/standalone_page.h"
#include "runtime/inverse/emulated_inverse.h"
#include "runtime/view/page_body.h"
#include "tests/support/padded_plate.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

using Json = nlohmann::json;

constexpr double kForceN = 1e-6;  // [N] what a person cannot tell, by far

#define NEEDS_A_PAGE()                                                          \
  if (!has_browser() || !std::filesystem::exists(page_module_file())) {         \
    GTEST_SKIP() << "no chromium, chromium-driver, python3-selenium, "          \
                    "python3-websocket, or no palpate.wasm (./bootstrap page)"; \
  }

struct Compared {
  int frames = 0;
  double force_n = 0.0;       // largest difference
  double most_n = 0.0;        // largest force
  double depth_m = 0.0;       // largest difference
  double remembered_j = 0.0;  // largest energy of dents
};

double difference(const Json& a, const Json& b) {
  double most = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    most = std::max(most, std::abs(a[k].get<double>() - b[k].get<double>()));
  }
  return most;
}

// A frame of both. Hands in the page's log: force and torque.
void compare(const Json& told, const Json& state, Compared& so_far) {
  ++so_far.frames;
  so_far.most_n = std::max(so_far.most_n, norm(state["force_n"]));
  so_far.force_n =
      std::max(so_far.force_n, difference(told["force_n"], state["force_n"]));
  so_far.depth_m = std::max(so_far.depth_m, std::abs(told["depth_m"].get<double>() -
                                                     state["depth_m"].get<double>()));
  so_far.remembered_j = std::max(so_far.remembered_j, state["memory_j"].get<double>());
  EXPECT_EQ(told["fault"], state["fault"]);
  for (std::size_t i = 0; i < told["hands"].size(); ++i) {
    Json hand = state["hands"][i]["force_n"];
    for (const Json& torque : state["hands"][i]["torque_n_m"]) {
      hand.push_back(torque);
    }
    so_far.force_n = std::max(so_far.force_n, difference(told["hands"][i], hand));
  }
}

// What the page's workers carried.
void replay_device(PageDevice& device, const Json& entry) {
  const auto ns = [](const Json& ms) {
    return nanoseconds_in(1e-3 * ms.get<double>());
  };
  if (entry.contains("watch")) {
    device.watch(ns(entry["watch"]));
  } else if (entry.contains("event")) {
    device.hear_event(entry["event"].get<std::string>());
  } else if (entry.contains("gone")) {
    device.let_go(entry["gone"].get<std::string>());
  } else {
    const Json& hear = entry["hear"];
    device.hear(entry["given"].get<std::string>(), {.now_ns = ns(hear[0]),
                                                    .received_ns = ns(hear[1]),
                                                    .withheld = hear[2].get<bool>(),
                                                    .asked = hear[3].get<bool>()});
  }
}

// This machine's runtime, asked what the page's was, when it was.
Compared replayed(const ResponseDatabase& database,
                  const std::vector<std::string>& tools, const Json& log) {
  PageBody body(database, "body.h5", {.tools = tools});
  Compared compared;
  for (const Json& entry : log) {
    if (entry.contains("text")) {
      body.receive(entry["text"].get<std::string>());
    } else if (entry.contains("now")) {
      body.frame(nanoseconds_in(1e-3 * entry["now"].get<double>()));
    } else if (!entry.contains("told")) {
      replay_device(body.device(), entry);
    } else {
      while (const std::optional<std::string> text = body.take()) {
        const Json state = parse_json(*text);
        if (state["type"] == "state") {
          compare(entry["told"], state, compared);
        }
      }
    }
  }
  return compared;
}

// What the script saw, and both runtimes' forces.
Compared compared(const Json& seen, const ResponseDatabase& database,
                  const std::vector<std::string>& tools = {}) {
  if (!seen.is_object()) {
    ADD_FAILURE() << "the script saw nothing";
    return {};
  }
  EXPECT_EQ(seen["errors"], Json::array());
  EXPECT_EQ(seen["loaded"], Json::array());
  const Compared both = replayed(database, tools, seen["log"]);
  EXPECT_GT(both.frames, 60);
  EXPECT_GT(both.most_n, 0.05);
  EXPECT_LT(both.force_n, kForceN);
  EXPECT_LT(both.depth_m, 1e-9);
  fmt::print(
      "[ page     ] started in {:.0f} ms, {:.0f} frames/s, speed {:.2f}; {} "
      "frames compared, forces to {:.2g} N differ by {:.2g} N\n",
      seen["start_ms"].get<double>(), seen["frames_per_s"].get<double>(),
      seen["speed"].get<double>(), both.frames, both.most_n, both.force_n);
  return both;
}

// Without another command, of forces that are not zero.
double longest_held_s(const std::vector<MotorRecord>& trace) {
  double longest_s = 0.0;
  for (std::size_t i = 1; i < trace.size(); ++i) {
    if (trace[i - 1].force_n > 0.0) {
      longest_s =
          std::max(longest_s, seconds_in(trace[i].time_ns - trace[i - 1].time_ns));
    }
  }
  return longest_s;
}

ResponseDatabase soft_body() {
  return sample_database(
      plate(0.1, 20), ball(0.008, 0.3, 5e-4),
      [](Eigen::Index node, double d) {
        return (200.0 + static_cast<double>(node % 7)) * d + 5e3 * d * d;
      },
      0.01);
}

TEST(OwnPage, PressedByMouseAndKeysFeelsAsThisMachine) {
  NEEDS_A_PAGE();
  const ResponseDatabase database = soft_body();
  compared(seen_on_own_page(database, {}, ""), database);
}

TEST(OwnPage, AFingerPressesASecondOneLetsGoAndBesideTheBodyItTurns) {
  NEEDS_A_PAGE();
  const ResponseDatabase database = soft_body();
  const Json seen = seen_on_own_page(database, {}, "--touch");
  compared(seen, database);
  EXPECT_GT(seen["finger_force_n"], 0.05);
  EXPECT_GT(difference(seen["camera"][0], seen["camera"][1]), 1e-3);
  EXPECT_EQ(seen["turned_force"], "0.000");
}

TEST(OwnPage, ABodyThatRelaxesAndYieldsDoesSoInThePage) {
  NEEDS_A_PAGE();
  ResponseDatabase database = soft_body();
  Viscoelasticity relaxes;
  relaxes.instantaneous = true;
  relaxes.tau_s = {0.05, 0.6};
  relaxes.g.resize(1, 2);
  relaxes.g << 0.3F, 0.2F;
  relaxes.yielding = {.yield_depth_m = {0.001}, .share = {0.3}};
  give_memory(database.body, database.normal, relaxes, 2, database.tools[0]);
  EXPECT_GT(compared(seen_on_own_page(database, {}, ""), database).remembered_j, 1e-6);
}

// A person's hand on an emulated Inverse3, felt through the page.
TEST(OwnPage, ADevicePressesThroughThePageAndEndsAtZeroForce) {
  NEEDS_A_PAGE();
  constexpr double kClearM = 0.01;
  const ResponseDatabase database = sample_database(
      plate(0.1, 20), ball(0.008, 0.05, 5e-4),
      [](Eigen::Index, double d) {
        return 60.0 * d;
      },
      0.01);
  EmulatedInverseConfig wanted;
  wanted.hand = {.surface_m = inverse_rest_m() - kClearM * Eigen::Vector3d::UnitY(),
                 .normal = Eigen::Vector3d::UnitY(),
                 .clear_m = kClearM,
                 .press_m = 0.005,
                 .deeper_m = 0.008,
                 .still_s = 4.0};
  wanted.trace_max = 200'000;
  EmulatedInverse service(wanted);
  const Json seen = seen_on_own_page(database, {}, "--device",
                                     {service.port(), service.events_port()});
  if (seen["device"]["detail"].get<std::string>().starts_with("messages of")) {
    GTEST_SKIP() << seen["device"]["detail"];
  }
  ASSERT_EQ(seen["device"]["phase"], "on") << seen["device"];
  compared(seen, database);
  EXPECT_NE(seen["told"].get<std::string>().find("hold the tool loosely"),
            std::string::npos);
  EXPECT_EQ(seen["holding"], false);
  EXPECT_EQ(seen["phase"], "on");
  EXPECT_EQ(seen["after"], "on");
  EXPECT_NE(seen["hung"].get<std::string>().find("fault"), std::string::npos)
      << seen["hung"];
  EXPECT_EQ(seen["off"], "");
  EXPECT_EQ(service.refused(), "");
  EXPECT_EQ(service.force_n(), Eigen::Vector3d::Zero());
  EXPECT_LT(service.given_to_hand_j(), 0.01);
  fmt::print(
      "[ device   ] {:.0f} forces a second, stiffness times {:.2f}, {:.2g} mJ to "
      "the hand, longest force held {:.0f} ms\n",
      seen["hz"].get<double>(), seen["settings"]["stiffness_scale"].get<double>(),
      1e3 * service.given_to_hand_j(), 1e3 * longest_held_s(service.trace()));
  // While its runtime hung, for 0.9 s, its worker let go.
  EXPECT_LT(longest_held_s(service.trace()), 0.45);
}

// Its runtime's own sentence, thrown and caught in WebAssembly.
TEST(OwnPage, ADamagedDatabaseIsRefused) {
  NEEDS_A_PAGE();
  std::vector<std::byte> flat = flat_bytes(soft_body());
  flat.resize(flat.size() - 8);
  const std::string module = read_file(page_module_file());
  const Json seen = seen_on_file(
      standalone_page({.name = "body.h5", .tools = {}, .left_out = "", .flat = flat},
                      std::as_bytes(std::span(module))),
      "");
  ASSERT_TRUE(seen.is_object());
  try {
    static_cast<void>(read_database(StoredSource(flat, "body.h5")));
    FAIL() << "is read";
  } catch (const FormatError& error) {
    EXPECT_EQ(seen["refused"], error.what());
  }
}

TEST(OwnPage, ANamedBodyFeelsAsThisMachine) {
  NEEDS_A_PAGE();
  const char* const body = std::getenv("PALPATE_PAGE_BODY");
  if (body == nullptr) {
    GTEST_SKIP() << "PALPATE_PAGE_BODY names no database";
  }
  const ResponseDatabase database = read_database(std::filesystem::path(body));
  compared(seen_on_own_page(database, {}, ""), database);
}

TEST(OwnPage, TwoHandsPinchInThePage) {
  NEEDS_A_PAGE();
  const ResponseDatabase database = padded_plate(3);
  const std::vector<std::string> tools{"ball", "pads"};
  compared(seen_on_own_page(database, tools, "--pinch"), database, tools);
}

}  // namespace
}  // namespace palpate
