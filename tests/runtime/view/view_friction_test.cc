// Friction behind the live view: what pages are told of a contact that sticks and
// slips.
#include "runtime/view/view_friction.h"

#include <atomic>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "runtime/run/render_run.h"
#include "runtime/view/view_json.h"
#include "runtime/view/view_session.h"
#include "tests/support/layered_plate.h"
#include "tests/support/rubbing_plate.h"

namespace palpate {
namespace {

using Json = nlohmann::json;

constexpr double kPrinted = 1e-5;  // of a trace's numbers, six digits each

class ViewFrictionTest : public testing::TestWithParam<bool> {
 protected:
  static ViewSessionOptions options() {
    ViewSessionOptions o;
    o.device.coulomb_n = 0.0;
    o.device.resolution_m = 0.0;
    return o;
  }

  // The hand presses there, `depth_m` below touch, and waits.
  Json press(double x_m, double depth_m = 0.004, double seconds = 0.5) {
    session_.follow({.hold = true, .target_m = {x_m, 0.0, kRubBallM - depth_m}});
    session_.advance(static_cast<std::int64_t>(seconds * session_.fast_hz()));
    const ViewFrame frame = session_.frame();
    return parse_json(frame_text(frame, session_.take_ticks()));
  }

  // [N/m] at a depth.
  static double stiffness(double depth_m) {
    return GetParam() ? kRubShare * kRubNPerM
                      : kRubFriction * kRubNPerM * depth_m / kRubPreslidingM;
  }

  ResponseDatabase database_ = rubbing_plate(GetParam());
  ViewSession session_{database_, options()};
};

INSTANTIATE_TEST_SUITE_P(ByBody, ViewFrictionTest, testing::Bool());

TEST_P(ViewFrictionTest, SticksBeforeItSlips) {
  const Json above = press(0.0, -0.005)["friction"];
  EXPECT_EQ(above["state"], "free");
  EXPECT_TRUE(above["anchor"].is_null());
  EXPECT_EQ(above["limit_n"], 0.0);
  press(0.0);
  const Json text = press(0.0003);
  const Json& stuck = text["friction"];
  const double depth_m = text["depth_m"];
  EXPECT_EQ(stuck["state"], "sticks");
  EXPECT_NEAR(stuck["limit_n"], kRubFriction * kRubNPerM * depth_m, 1e-9);
  EXPECT_NEAR(stuck["n_per_m"], stiffness(depth_m), 1e-6 * stiffness(depth_m));
  const double stretch_m = stuck["stretch_m"][0];
  EXPECT_GT(stretch_m, 1e-4);
  EXPECT_NEAR(stuck["force_n"][0], -stiffness(depth_m) * stretch_m, 1e-9);
  // It stuck about where it came down: the anchor follows a little while the hand's
  // force swings.
  EXPECT_NEAR(stuck["anchor"]["point_m"][0], 0.0, 5e-5);
  EXPECT_NEAR(
      text["contact_m"][0].get<double>() - stuck["anchor"]["point_m"][0].get<double>(),
      stretch_m, 1e-6);

  const Json far = press(0.02, 0.004, 0.1);  // on its way
  const Json& slips = far["friction"];
  EXPECT_EQ(slips["state"], "slips");
  EXPECT_NEAR(slips["force_n"][0], -slips["limit_n"].get<double>(), 1e-6);
  EXPECT_NEAR(slips["anchor"]["point_m"][0],
              far["contact_m"][0].get<double>() - slips["stretch_m"][0].get<double>(),
              1e-9);
}

// Force against displacement, along x.
struct Loop {
  std::vector<double> slid_m;
  std::vector<double> force_n;
  std::vector<double> limit_n;
};

Loop loop_of(const Json& text) {
  const Json& trace = text["friction"]["trace"];
  Loop loop;
  for (std::size_t i = 0; i < trace["limit_n"].size(); ++i) {
    loop.slid_m.push_back(trace["slid_m"][3 * i]);
    loop.force_n.push_back(trace["force_n"][3 * i]);
    loop.limit_n.push_back(trace["limit_n"][i]);
  }
  return loop;
}

// Between two ticks of one contact that stuck meanwhile the force falls by K times the
// way. A change of K changes it by the same share at most. Where it slips it is at the
// limit.
TEST_P(ViewFrictionTest, TheLoopIsThatOfASpringAndCoulombsLimit) {
  press(0.0, -0.005);  // from above: nothing is stretched across
  press(0.0);
  const Loop out = loop_of(press(0.012));
  const Loop back = loop_of(press(-0.002));
  const Json text = press(0.012);
  const Loop again = loop_of(text);
  ASSERT_EQ(again.slid_m.size(), text["trace"]["depth_m"].size());
  for (const Loop* loop : {&out, &back, &again}) {
    int slips = 0, sticks = 0;
    for (std::size_t i = 1; i < loop->slid_m.size(); ++i) {
      const double limit_n = loop->limit_n[i];
      ASSERT_LE(std::abs(loop->force_n[i]), limit_n * (1.0 + kPrinted));
      const double way_m = loop->slid_m[i] - loop->slid_m[i - 1];
      const double limit = 0.97 * limit_n;  // above it a tick may end a stick
      if (std::abs(loop->force_n[i]) > limit) {
        ++slips;
      } else if (std::abs(loop->force_n[i - 1]) < limit && std::abs(way_m) > 1e-6) {
        ++sticks;
        const double depth_m = limit_n / (kRubFriction * kRubNPerM);
        const double fell_n = loop->force_n[i - 1] - loop->force_n[i];
        const double by_change_n = std::abs(loop->force_n[i - 1]) *
                                   std::abs(limit_n - loop->limit_n[i - 1]) / limit_n;
        const double printed_n =
            2.0 * kPrinted * (stiffness(depth_m) * std::abs(loop->slid_m[i]) + limit_n);
        EXPECT_NEAR(fell_n, stiffness(depth_m) * way_m, printed_n + 1.1 * by_change_n)
            << i;
      }
    }
    EXPECT_GT(slips, 20);
    EXPECT_GT(sticks, 5);
  }
  // The hand swings back a little where it stops: less than to the other side.
  EXPECT_LT(again.force_n.back(), -0.5 * again.limit_n.back());
  EXPECT_GT(back.force_n.back(), 0.5 * back.limit_n.back());
}

TEST_P(ViewFrictionTest, AnotherContactBeginsAtNothing) {
  press(0.0);
  press(0.012);
  EXPECT_TRUE(loop_of(press(0.012, -0.005)).slid_m.size() < 1000U);
  EXPECT_TRUE(loop_of(press(0.012, -0.005)).slid_m.empty());
  const Loop anew = loop_of(press(0.012));
  ASSERT_FALSE(anew.slid_m.empty());
  EXPECT_EQ(anew.slid_m[0], 0.0);
  EXPECT_LT(std::abs(anew.slid_m.back()), 1e-6);
}

// What a tick moved along the normal is no slip.
TEST(FrictionTrail, AddsUpWhatMovesInThePlane) {
  FrictionSeen seen;
  seen.n_per_m = 100.0;
  seen.limit_n = 0.3;
  seen.force_n = {-0.2, 0.0, 0.0};
  seen.normal = {0.0, 0.6, 0.8};
  FrictionTrail trail;
  trail.add(seen);
  seen.tool_m = {0.001, 0.0, 0.01};
  seen.normal = {0.0, 0.0, 1.0};
  trail.add(seen);
  const ViewFriction friction = trail.take();
  ASSERT_EQ(friction.ticks.size(), 2U);
  EXPECT_EQ(friction.ticks[0].slid_m, Eigen::Vector3d::Zero());
  // Across the normal of the tick before: 0.01 z less 0.008 n.
  EXPECT_TRUE(friction.ticks[1].slid_m.isApprox(Vector3(0.001, -0.0048, 0.0036)));
  EXPECT_TRUE(friction.ticks[1].force_n.isApprox(Vector3(-0.2, 0.0, 0.0)));
  EXPECT_EQ(friction.ticks[1].limit_n, 0.3);
  EXPECT_TRUE(trail.take().ticks.empty());
  // At most the latest ones wait.
  for (std::size_t i = 0; i < kTicksKept + 3; ++i) {
    seen.tool_m[0] += 1e-6;
    trail.add(seen);
  }
  const std::vector<RubbedTick> kept = trail.take().ticks;
  ASSERT_EQ(kept.size(), kTicksKept);
  EXPECT_NEAR(kept.front().slid_m.x(), 0.001 + 4e-6, 1e-12);
}

Json body_json(const ResponseDatabase& database) {
  return parse_json(body_text({.database = database,
                               .table = database.tools[0],
                               .name = "plate",
                               .device = ""}));
}

TEST(ViewFriction, ToolsWithoutFrictionHaveNone) {
  EXPECT_EQ(body_json(rubbing_plate())["rubs"], true);
  ResponseDatabase smooth = sample_database(
      plate(0.1, 10), ball(0.005, 0.0, 0.0),
      [](Eigen::Index, double d) {
        return 200.0 * d;
      },
      0.01);
  ResponseDatabase needle = layered_plate();
  needle.tools[0].tool.friction = 0.3;
  for (const ResponseDatabase* database : {&smooth, &needle}) {
    ViewSession session(*database, {});
    session.advance(10);
    const Json text = parse_json(frame_text(session.frame(), session.take_ticks()));
    EXPECT_FALSE(text.contains("friction"));
    EXPECT_EQ(body_json(*database)["rubs"], false);
  }
  smooth.tools[0].friction[3] = 0.2;  // one node's material
  EXPECT_TRUE(shows_friction(smooth.tools[0]));
}

// The fast thread says every tick to who looks on.
TEST(ViewFriction, ARunShowsEveryTick) {
  const ResponseDatabase database = rubbing_plate();
  const auto watch = std::make_unique<FrictionWatch>();
  SimulationOptions options;
  options.duration_s = 1.0;
  options.watch_friction = watch.get();
  const std::atomic<bool> stop = false;
  const SimulationReport report = simulate(database, options, stop);
  int ticks = 0, pressed = 0;
  while (const FrictionSeen* seen = watch->front()) {
    pressed += seen->limit_n > 0.0 ? 1 : 0;
    ++ticks;
    watch->pop();
  }
  EXPECT_EQ(watch->dropped(), 0U);
  EXPECT_GE(ticks, report.render.ticks);
  EXPECT_LE(ticks, report.render.ticks + 1);  // one is said before the first tick
  EXPECT_GT(pressed, 100);
}

}  // namespace
}  // namespace palpate
