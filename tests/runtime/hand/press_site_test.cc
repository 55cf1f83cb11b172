#include "runtime/hand/press_site.h"

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

double linear(Eigen::Index /*node*/, double depth_m) {
  return 100.0 * depth_m;
}

// A plate of 11 x 11 nodes; only columns i < 7 have a response.
ResponseDatabase half_reached() {
  ResponseDatabase database =
      sample_database(plate(0.1, 10), ball(0.005, 0.0, 0.0), linear, 0.01);
  std::vector<NodeResponse> responses(121);
  for (std::size_t v = 0; v < responses.size(); ++v) {
    if (v % 11 > 0 && v % 11 < 7 && v / 11 > 0 && v / 11 < 10) {
      responses[v] = {.direction = Eigen::Vector3d::UnitZ(),
                      .depth_m = {0.0, 0.01},
                      .force_n = {0.0, 1.0},
                      .origin = ResponseOrigin::kSimulated};
    }
  }
  database.tools[0] = make_table(database.tools[0].tool, responses);
  return database;
}

TEST(HandPlace, PressesDeepInsideTheReachablePart) {
  const ResponseDatabase database = half_reached();
  const std::int32_t node = node_to_press(database, database.tools[0], std::nullopt);
  EXPECT_GE(node % 11, 3);
  EXPECT_LE(node % 11, 4);
  EXPECT_GE(node / 11, 3);
  EXPECT_LE(node / 11, 7);
}

TEST(HandPlace, TakesTheNearestNodeThatHasAResponse) {
  const ResponseDatabase database = half_reached();
  const std::int32_t node =
      node_to_press(database, database.tools[0], Eigen::Vector3d(0.05, 0.0, 0.0));
  EXPECT_EQ(node, 5 * 11 + 6);
}

TEST(HandPlace, RefusesABodyWithoutResponses) {
  ResponseDatabase database = half_reached();
  database.tools[0] =
      make_table(database.tools[0].tool, std::vector<NodeResponse>(121));
  EXPECT_THROW((void)node_to_press(database, database.tools[0], std::nullopt),
               InputError);
}

TEST(HandPlace, PressesWithinTheCurveAndTheForce) {
  const ResponseDatabase database = half_reached();
  const ResponseTable& table = database.tools[0];
  const HandScript deep = script_at(database, table, 60, 100.0, 1.0, 300.0);
  EXPECT_NEAR(deep.press_m, 0.003 + 0.3 / 300.0, 1e-12);
  EXPECT_NEAR(deep.deeper_m, 0.006 + 0.6 / 300.0, 1e-12);
  const HandScript weak = script_at(database, table, 60, 0.5, 1.0, 300.0);
  EXPECT_NEAR(weak.deeper_m, 0.004 + 0.4 / 300.0, 1e-4);  // 0.8 of 0.5 N
  EXPECT_EQ(weak.touch_m, 0.005);
}

}  // namespace
}  // namespace palpate
