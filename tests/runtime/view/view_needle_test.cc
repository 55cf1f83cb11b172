// A needle behind the live view: what pages are told of it, and that it can be pushed
// through layers, pulled out and inserted again.
#include "runtime/view/view_needle.h"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "runtime/view/view_json.h"
#include "runtime/view/view_session.h"
#include "tests/support/layered_plate.h"
#include "tests/support/said.h"

namespace palpate {
namespace {

using Json = nlohmann::json;

class ViewNeedleTest : public testing::Test {
 protected:
  static ViewSessionOptions options() {
    ViewSessionOptions o;
    o.device.coulomb_n = 0.0;
    o.device.resolution_m = 0.0;
    return o;
  }

  ViewNeedleTest() { push_to(-0.005); }

  // The hand goes to a depth below touch, and waits there.
  void push_to(double depth_m, double seconds = 1.0) {
    session_.follow({.hold = true, .target_m = {0.0, 0.0, kLayerNeedleM - depth_m}});
    wait(seconds);
  }
  void wait(double seconds) {
    session_.advance(static_cast<std::int64_t>(seconds * session_.fast_hz()));
    frame_ = session_.frame();
    text_ = parse_json(frame_text(frame_, session_.take_ticks()));
  }

  ResponseDatabase database_ = layered_plate();
  ViewSession session_{database_, options()};
  ViewFrame frame_;
  Json text_;
};

// What broke in an earlier run left a channel, and no numbers.
TEST_F(ViewNeedleTest, ShowsTheChannelOfAnEarlierRun) {
  push_to(0.02);
  const Json before = text_["needle"]["channels"][0];
  ViewSessionOptions later = options();
  later.surface = session_.kept();
  ViewSession session(database_, later);
  session.advance(1);
  const Json needle =
      parse_json(frame_text(session.frame(), session.take_ticks()))["needle"];
  ASSERT_EQ(needle["channels"].size(), 1U);
  const Json& channel = needle["channels"][0];
  EXPECT_EQ(needle["in"], -1);
  EXPECT_EQ(channel["entry_m"], before["entry_m"]);
  EXPECT_EQ(channel["depth_m"], before["depth_m"]);
  EXPECT_EQ(channel["broke_n"].size(), before["broke_n"].size());
  EXPECT_TRUE(channel["broke_n"][0].is_null());
}

TEST_F(ViewNeedleTest, SaysWhereTheChannelIsAndWhatBroke) {
  push_to(0.004);
  EXPECT_EQ(text_["needle"]["in"], -1);
  EXPECT_EQ(text_["needle"]["channels"], Json::array());
  EXPECT_NEAR(text_["needle"]["axial_n"], frame_.now.force_n[2], 1e-12);
  push_to(0.02);
  ASSERT_EQ(text_["needle"]["in"], 0);
  const Json& channel = text_["needle"]["channels"][0];
  // The tip entered at the plate, along its normal.
  EXPECT_NEAR(channel["entry_m"][2], 0.0, 1e-6);
  EXPECT_NEAR(channel["axis"][2], 1.0, 1e-9);
  EXPECT_EQ(text_["needle"]["membranes"], 2);
  ASSERT_EQ(channel["layers_m"].size(), 3U);
  EXPECT_NEAR(channel["layers_m"][1], 0.005, 1e-15);  // the same of three nodes
  EXPECT_EQ(channel["materials"], Json::parse("[0, 1, 2]"));
  // The first broke at its force, where the curve has it.
  ASSERT_EQ(channel["broke_n"].size(), 2U);
  EXPECT_NEAR(channel["broke_n"][0], kLayerSkinN, 0.02);
  EXPECT_NEAR(channel["broke_m"][0], kLayerSkinN / kLayerNPerM, 1e-4);
  EXPECT_GE(channel["broke_m"][1], 0.005);
  // Depths are the tip's. Beyond the channel's end it deforms the tissue before it.
  const double tip_m = text_["depth_m"];
  EXPECT_NEAR(tip_m, kLayerNeedleM - frame_.now.position_m[2], 1e-6);
  const double ahead_m = tip_m - channel["depth_m"].get<double>();
  EXPECT_GT(ahead_m, 0.0);
  EXPECT_LE(ahead_m, kLayerCutN / kLayerNPerM + 1e-6);
  EXPECT_NEAR(text_["penetration_m"], 0.0, 1e-6);
  EXPECT_EQ(text_["trace"]["axial_n"].size(), text_["trace"]["depth_m"].size());
  EXPECT_NEAR(text_["trace"]["axial_n"].back(), frame_.now.force_n[2], 1e-5);
  EXPECT_NEAR(text_["trace"]["depth_m"].back(), tip_m, 1e-7);
}

TEST_F(ViewNeedleTest, LettingGoPullsItOutAndTheChannelStays) {
  push_to(0.02);
  const double deep_m = text_["needle"]["channels"][0]["depth_m"];
  session_.let_go();
  wait(0.02);
  EXPECT_EQ(text_["needle"]["in"], 0);  // still under way
  wait(1.0);
  EXPECT_EQ(frame_.fault, "none");
  EXPECT_FALSE(session_.touching());
  EXPECT_EQ(text_["needle"]["in"], -1);
  EXPECT_EQ(text_["needle"]["channels"][0]["depth_m"], deep_m);
  // The ticks in which it left count along the channel: none jumps.
  double before_m = text_["trace"]["depth_m"][0];
  EXPECT_GT(before_m, 0.01);
  for (const Json& depth_m : text_["trace"]["depth_m"]) {
    EXPECT_LT(std::abs(depth_m.get<double>() - before_m), 4e-4);
    before_m = depth_m;
  }
  // Again: along the same channel, where nothing breaks.
  push_to(0.015);
  EXPECT_EQ(text_["needle"]["in"], 0);
  EXPECT_EQ(text_["needle"]["membranes"], 2);
  EXPECT_LT(text_["needle"]["axial_n"], 0.5 * kLayerSkinN);
  session_.reset();
  wait(0.01);
  EXPECT_EQ(text_["needle"]["channels"], Json::array());
}

TEST_F(ViewNeedleTest, ItIsPulledOutAlongItsChannel) {
  push_to(0.02);
  session_.let_go();
  wait(2.0);
  EXPECT_NEAR(frame_.now.position_m[0], 0.0, 1e-6);
  EXPECT_GT(frame_.now.position_m[2], kLayerNeedleM + 0.004);
}

TEST_F(ViewNeedleTest, HasTheModelsThatANeedleNeeds) {
  const Json body = parse_json(body_text({.database = database_,
                                          .table = database_.tools[0],
                                          .name = "plate",
                                          .device = ""}));
  EXPECT_EQ(body["models"], Json::parse(R"(["potential", "facets"])"));
  EXPECT_EQ(body["puncture"]["materials"], Json::parse(R"(["skin", "fat", "muscle"])"));
  EXPECT_EQ(body["puncture"]["deepest_m"], 0.02);
  EXPECT_EQ(refusal([&] {
              session_.set({.model = LocalModel::kSingle, .stiffness_scale = 2.0});
            }),
            "a needle needs the model potential or facets");
  EXPECT_EQ(session_.frame().settings.model, LocalModel::kPotential);
  EXPECT_EQ(session_.frame().settings.stiffness_scale, 1.0);
  session_.set({.model = LocalModel::kFacets});
  push_to(0.02);
  EXPECT_EQ(text_["needle"]["in"], 0);
}

TEST_F(ViewNeedleTest, OtherToolsHaveNone) {
  ResponseDatabase ball = database_;
  ball.tools[0].puncture = {};
  ViewSession session(ball, options());
  const Json text = parse_json(frame_text(session.frame(), session.take_ticks()));
  EXPECT_FALSE(text.contains("needle"));
  EXPECT_FALSE(text["trace"].contains("axial_n"));
  const Json body = parse_json(body_text(
      {.database = ball, .table = ball.tools[0], .name = "plate", .device = ""}));
  EXPECT_TRUE(body["puncture"].is_null());
  EXPECT_GT(body["models"].size(), 2U);
}

}  // namespace
}  // namespace palpate
