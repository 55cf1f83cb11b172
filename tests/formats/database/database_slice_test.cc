#include "formats/database/database_slice.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/response/response_curve.h"
#include "tests/support/small_database.h"
#include "tests/support/sphere_database.h"

namespace palpate {
namespace {

TEST(DatabaseSlice, ACutCurveIsTheSameCubicUpToTheCut) {
  const ResponseDatabase database = sphere_database(6, 9);
  for (const double depth_m : {0.0001, 0.0013, 0.0029, 0.00499}) {
    ResponseDatabase part = slice(database, {.depth_max_m = depth_m});
    EXPECT_NO_THROW(check(part));
    const ResponseTable& a = database.tools[0];
    const ResponseTable& b = part.tools[0];
    for (std::int64_t i = 0; i < a.nodes(); ++i) {
      EXPECT_EQ(b.curve(i).depth_max_m(), depth_m);
      for (int j = 0; j <= 20; ++j) {
        const double d = depth_m * j / 20;
        const ResponseSample x = a.curve(i).at(d);
        const ResponseSample y = b.curve(i).at(d);
        EXPECT_NEAR(y.force_n, x.force_n, 1e-12 * (1.0 + x.force_n));
        EXPECT_NEAR(y.energy_j, x.energy_j, 1e-14);
      }
    }
    EXPECT_FALSE(part.provenance.left_out.empty());
  }
}

TEST(DatabaseSlice, ACutThroughASteepFlatSteepCubicKeepsTheRules) {
  // Slopes 3, 3 over a secant of 1: flat in the middle. Cut at three quarters, the last
  // slope would be 4 secants without a sample where it is flat.
  ResponseTable table = small_database().tools[0];
  const std::vector<double> depth = {0.0, 1.0};
  const std::vector<double> force = {0.0, 1.0};
  NodeResponse response;
  response.direction = Eigen::Vector3d::UnitZ();
  response.origin = ResponseOrigin::kSimulated;
  response.depth_m = depth;
  response.force_n = force;
  table = make_table(table.tool, {response});
  table.stiffness_n_per_m = {3.0, 3.0};
  const ResponseTable part = cut(table, 0.75);
  const CurveView curve = part.curve(0);
  ASSERT_EQ(curve.depth_m.size(), 3u);
  EXPECT_NEAR(curve.depth_m[1], 0.5, 1e-15);
  EXPECT_NEAR(curve.stiffness_n_per_m[1], 0.0, 1e-12);
  for (const double d : {0.1, 0.4, 0.6, 0.75}) {
    EXPECT_NEAR(curve.at(d).force_n, table.curve(0).at(d).force_n, 1e-14);
  }
}

TEST(DatabaseSlice, ABoxKeepsItsTrianglesAndTheirNodes) {
  const ResponseDatabase database = small_database();
  // The four triangles around the upper corner, node 4.
  const ResponseDatabase part =
      slice(database, {.box_m = Eigen::AlignedBox3d(Eigen::Vector3d(-1, -1, -0.01),
                                                    Eigen::Vector3d(1, 1, 1))});
  EXPECT_NO_THROW(check(part));
  EXPECT_EQ(part.body.position_m.rows(), 5);
  EXPECT_EQ(part.body.triangle.rows(), 4);
  EXPECT_EQ(part.provenance.plan_sha256, "") << "a part passes for the whole";
  EXPECT_EQ(part.provenance.left_out, "node 5: not reachable; slice: 1 of 6 nodes");
  const CurveView kept = part.tools[1].curve(4);
  EXPECT_TRUE(std::ranges::equal(kept.force_n, database.tools[1].curve(4).force_n));
  EXPECT_THROW(
      (void)slice(database, {.box_m = Eigen::AlignedBox3d(Eigen::Vector3d(2, 2, 2),
                                                          Eigen::Vector3d(3, 3, 3))}),
      InputError);
}

TEST(DatabaseSlice, KeepsTheToolsThatAreNamedInThatOrder) {
  const ResponseDatabase part = slice(small_database(), {.tools = {"ball"}});
  ASSERT_EQ(part.tools.size(), 1u);
  EXPECT_EQ(part.tools[0].tool.name, "ball");
  EXPECT_THROW((void)slice(small_database(), {.tools = {"bell"}}), InputError);
}

TEST(DatabaseMerge, PutsTogetherWhatSliceTookApart) {
  const ResponseDatabase whole = small_database();
  const ResponseDatabase merged =
      merge({slice(whole, {.tools = {"tip"}}), slice(whole, {.tools = {"ball"}})});
  ASSERT_EQ(merged.tools.size(), 2u);
  EXPECT_EQ(merged.tools[0].tool.name, "tip");
  EXPECT_EQ(merged.tools[1].force_n, whole.tools[1].force_n);
  EXPECT_NO_THROW(check(merged));
}

TEST(DatabaseMerge, RefusesWhatDoesNotBelongTogetherAndSaysWhy) {
  const ResponseDatabase whole = small_database();
  const ResponseDatabase tip = slice(whole, {.tools = {"tip"}});
  ResponseDatabase ball = slice(whole, {.tools = {"ball"}});
  const auto reason = [](const ResponseDatabase& a, const ResponseDatabase& b) {
    try {
      (void)merge({a, b});
      return std::string("merged");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
  };
  EXPECT_EQ(reason(tip, tip), "database 1 has the tool \"tip\" once more");
  ball.provenance.source_sha256 = std::string(64, 'b');
  EXPECT_NE(reason(tip, ball).find("another source"), std::string::npos);
  ball.body.position_m *= 2.0;
  EXPECT_NE(reason(tip, ball).find("the bodies differ: node 0"), std::string::npos);
}

}  // namespace
}  // namespace palpate
