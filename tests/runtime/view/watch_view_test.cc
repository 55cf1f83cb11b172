// Pages that watch a device's run: what they are told, and that they cannot steer.
#include "runtime/view/watch_view.h"

#include <map>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/response/tool_support.h"
#include "tests/support/layered_plate.h"
#include "tests/support/padded_plate.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

class JsonOutbox : public ViewOutbox {
 public:
  void send(ViewClient client, std::string text) override {
    sent[client] = parse_json(text);
  }
  void send_latest(ViewClient client,
                   const std::shared_ptr<const std::string>& text) override {
    frame[client] = parse_json(*text);
  }
  std::map<ViewClient, nlohmann::json> sent;
  std::map<ViewClient, nlohmann::json> frame;
};

class WatchViewTest : public testing::Test {
 protected:
  WatchViewTest() { view_.answer_through(outbox_); }

  ResponseDatabase database_ = sample_database(
      plate(0.1, 10), ball(0.005, 0.3, 5e-4),
      [](Eigen::Index, double d) {
        return 200.0 * d;
      },
      0.01);
  ViewedBody body_{.database = database_,
                   .table = database_.tools[0],
                   .name = "plate",
                   .device = "falcon",
                   .fast_hz = 1000.0,
                   .force_max_n = 8.0};
  static SimulationOptions options() {
    SimulationOptions o;
    o.fast_hz = 1000.0;
    o.slow_hz = 50.0;
    return o;
  }
  std::unique_ptr<TickQueue> ticks_ = std::make_unique<TickQueue>();
  WatchView view_{body_, options(), *ticks_};
  JsonOutbox outbox_;
};

TEST_F(WatchViewTest, ShowsEveryTickAndCountsTheLateOnes) {
  view_.opened(1);
  view_.frame();
  EXPECT_EQ(outbox_.frame[1]["state"], "waiting for the device");
  for (int i = 0; i < 40; ++i) {
    TickRecord tick{.tick = i,
                    .time_ns = 5'000'000'000 + i * 1'000'000,
                    .position_m = {0.001, 0.002, 0.003},
                    .force_n = {0.0, 0.0, 0.01 * i},
                    .depth_m = 0.002,
                    .work_j = 1e-3,
                    .flags = static_cast<std::uint8_t>(TickFlag::kContact)};
    if (i % 10 == 3) {
      tick.flags |= static_cast<std::uint8_t>(TickFlag::kSkipped);
    }
    ASSERT_TRUE(ticks_->push(tick));
  }
  view_.frame();
  const nlohmann::json& frame = outbox_.frame[1];
  EXPECT_EQ(frame["state"], "pressing");
  EXPECT_EQ(frame["run"]["ticks"], 40);
  EXPECT_EQ(frame["run"]["late_ticks"], 4);
  EXPECT_EQ(frame["run"]["force_max_n"], 0.39);
  EXPECT_TRUE(frame["run"]["step_p50_ns"].is_null());
  EXPECT_TRUE(frame["hand_m"].is_null());
  EXPECT_TRUE(frame["settings"]["stiffness_scale"].is_null());
  EXPECT_EQ(frame["settings"]["slow_hz"], 50.0);
  EXPECT_EQ(frame["trace"]["force_n"].size(), 40U);
  EXPECT_EQ(frame["trace"]["time_s"][0], 0.0);  // since the run's first tick
  EXPECT_NEAR(frame["time_s"], 0.039, 1e-9);
  EXPECT_NEAR(frame["contact_m"][2], 0.0, 1e-12);  // on the plate
  EXPECT_EQ(frame["net_j"], 1e-3);
  view_.frame();
  EXPECT_EQ(outbox_.frame[1]["trace"]["force_n"].size(), 0U);  // none twice
}

TEST_F(WatchViewTest, LetsNoPageSteer) {
  view_.opened(1);
  EXPECT_EQ(outbox_.sent[1]["role"], "watcher");
  for (const char* wish : {R"({"type":"point","hold":true,"target_m":[0,0,0]})",
                           R"({"type":"set","slow_hz":20})",
                           R"({"type":"run","do":"pause"})", "nonsense"}) {
    view_.received(1, wish);
    EXPECT_EQ(outbox_.sent[1]["type"], "refused") << wish;
  }
  view_.received(1, R"({"type":"node","node":3})");
  EXPECT_EQ(outbox_.sent[1]["type"], "curve");
  EXPECT_EQ(outbox_.sent[1]["node"], 3);
  view_.received(1, R"({"type":"field","node":3})");
  EXPECT_EQ(outbox_.sent[1]["type"], "field");
}

TEST_F(WatchViewTest, ForgetsAPageThatIsGone) {
  view_.opened(1);
  view_.opened(2);
  view_.closed(1);
  view_.frame();
  EXPECT_EQ(outbox_.frame.count(1), 0U);
  EXPECT_EQ(outbox_.frame[2]["clients"], 1);
}

// A tool of several contacts: each of them where the fast thread has it.
TEST_F(WatchViewTest, ShowsSeveralContacts) {
  const ResponseDatabase padded = padded_plate(2);
  const ResponseTable& pads = find_tool(padded, "pads");
  const ViewedBody body{.database = padded,
                        .table = pads,
                        .name = "plate",
                        .device = "falcon",
                        .fast_hz = 1000.0,
                        .force_max_n = 8.0,
                        .hands = {&pads}};
  const auto contacts = std::make_unique<ContactsWatch>();
  SimulationOptions watched = options();
  watched.watch_contacts = contacts.get();
  WatchView view(body, watched, *ticks_);
  view.answer_through(outbox_);
  view.opened(1);
  ContactsSeen seen;
  seen.count = 2;
  seen.hand[0].tool.position_m = {0.0, 0.0, 0.004};
  seen.hand[0].device.position_m = {0.0, 0.0, 0.003};
  seen.held = true;
  seen.hand[0].wrench = {{0.0, 0.0, 0.3}, {0.0, 0.002, 0.0}};
  seen.contact[1] = {.radius_m = kPadRadius,
                     .at = {.centre_m = {0.006, 0.0, 0.004},
                            .point_m = {0.006, 0.0, 0.0},
                            .normal = {0.0, 0.0, 1.0},
                            .force_n = {0.0, 0.0, 0.3},
                            .depth_m = 0.001,
                            .dimple_m = 0.0002,
                            .triangle = 7,
                            .share = {0.2, 0.3, 0.5},
                            .touching = true}};
  contacts->write(seen);
  ASSERT_TRUE(ticks_->push(
      {.tick = 0, .force_n = {0.0, 0.0, 0.3}, .torque_n_m = {0.0, 0.002, 0.0}}));
  view.frame();
  const nlohmann::json& frame = outbox_.frame[1];
  ASSERT_EQ(frame["hands"].size(), 1U);
  EXPECT_EQ(frame["hands"][0]["tool_m"][2], 0.004);
  EXPECT_EQ(frame["hands"][0]["hand_m"][2], 0.003);
  EXPECT_EQ(frame["hands"][0]["holding"], true);
  EXPECT_EQ(frame["hands"][0]["torque_n_m"][1], 0.002);
  ASSERT_EQ(frame["contacts"].size(), 1U);  // the first has found no body yet
  EXPECT_EQ(frame["contacts"][0]["force_n"][2], 0.3);
  EXPECT_NEAR(frame["contacts"][0]["own_m"], 0.0008, 1e-15);
  EXPECT_EQ(frame["contacts"][0]["nodes"][0], padded.body.triangle(7, 0));
  EXPECT_EQ(frame["contacts"][0]["shares"][2], 0.5);
  EXPECT_EQ(frame["compared"], false);
  EXPECT_EQ(frame["loads"]["force1_n"][0], 0.3);
  EXPECT_EQ(frame["loads"]["torque1_n_m"][0], 0.002);
}

// Of a needle, the channels of the tick that the fast thread showed last.
TEST_F(WatchViewTest, ShowsANeedle) {
  const ResponseDatabase punctured = layered_plate();
  const ViewedBody body{.database = punctured,
                        .table = punctured.tools[0],
                        .name = "plate",
                        .device = "falcon"};
  const auto needle = std::make_unique<NeedleWatch>();
  SimulationOptions watched = options();
  watched.watch_needle = needle.get();
  WatchView view(body, watched, *ticks_);
  view.answer_through(outbox_);
  view.opened(1);
  view.frame();
  EXPECT_EQ(outbox_.frame[1]["needle"]["in"], -1);  // there before any tick
  NeedleSeen seen;
  seen.punctures = true;
  NeedleState& state = seen.state;
  state.channels = 1;
  state.active = 0;
  state.channel[0].axis = {0.0, 0.0, 1.0};
  state.channel[0].entry_m = {0.001, 0.0, kLayerNeedleM};
  state.channel[0].depth_m = 0.006;
  needle->write(seen);
  ASSERT_TRUE(ticks_->push({.position_m = {0.001, 0.0, -0.005},
                            .force_n = {0.1, 0.0, 0.4},
                            .depth_m = 0.001}));
  view.frame();
  const nlohmann::json& frame = outbox_.frame[1];
  EXPECT_EQ(frame["needle"]["in"], 0);
  EXPECT_EQ(frame["needle"]["axial_n"], 0.4);
  EXPECT_EQ(frame["needle"]["channels"][0]["depth_m"], 0.006);
  EXPECT_NEAR(frame["depth_m"], 0.007, 1e-15);
  EXPECT_NEAR(frame["penetration_m"], 0.0, 1e-15);
}

TEST_F(WatchViewTest, ShowsAFault) {
  view_.opened(1);
  TickRecord tick;
  tick.fault = static_cast<std::uint8_t>(Fault::kDeviceLost);
  ASSERT_TRUE(ticks_->push(tick));
  view_.frame();
  EXPECT_EQ(outbox_.frame[1]["fault"], "device-lost");
}

}  // namespace
}  // namespace palpate
