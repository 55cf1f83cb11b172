#include "formats/response/puncture.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/punctured_sphere.h"

namespace palpate {
namespace {

constexpr double kUnknownJ = std::numeric_limits<double>::quiet_NaN();

TEST(Puncture, IsToldInALine) {
  EXPECT_EQ(describe(Puncture{}), "");
  Puncture puncture = some_puncture(6);
  EXPECT_EQ(
      describe(puncture),
      "the first membrane breaks at 2 to 2.05 N; up to 3 layers; skin: membrane 3 "
      "N, cutting 0.5 N, friction 15 N/m, 1.3 times it at rest; muscle: membrane "
      "0.6 N, cutting 0.2 N, friction 40 N/m, 1.2 times it at rest; bone is not cut");
  puncture = some_puncture(1);
  puncture.rule = "energy";
  EXPECT_TRUE(describe(puncture).starts_with("the first membrane breaks at 2 J; "));
}

TEST(Puncture, SaysTheEnergyOfAMembrane) {
  EXPECT_NE(describe(known_puncture(1)).find("; muscle: membrane 0.002 J, cutting"),
            std::string::npos);
}

TEST(Puncture, ANeedleIsNamedByItsOwnRadius) {
  const ToolShape ball{.name = "n", .radius_m = 0.003};
  Puncture puncture = known_puncture(1);
  EXPECT_EQ(describe_tool(ball, puncture),
            "needle of radius 0.75 mm, tip angle 30 deg, pressed as sphere of radius 3 "
            "mm");
  puncture.tip_angle_rad = 0.0;
  EXPECT_EQ(describe_tool(ball, puncture),
            "needle of radius 0.75 mm, pressed as sphere of radius 3 mm");
  EXPECT_EQ(describe_tool({.name = "n", .radius_m = 7.5e-4}, puncture),
            "needle of radius 0.75 mm");
  // Older files do not know it, and a ball is a ball.
  EXPECT_EQ(describe_tool(ball, some_puncture(1)), "sphere of radius 3 mm");
  EXPECT_EQ(describe_tool(ball, {}), "sphere of radius 3 mm");
}

TEST(Puncture, DoubtsCurvesThatGoDeeperThanWasCompared) {
  const ToolShape ball{.name = "n", .radius_m = 0.003};
  const Puncture puncture = known_puncture(1);
  const double compared_m = kComparedRadii * puncture.radius_m;
  EXPECT_EQ(doubts_of_depth(ball, puncture, 0.999 * compared_m), "");
  EXPECT_EQ(
      doubts_of_depth(ball, puncture, compared_m + 5.0 * puncture.radius_m),
      "its curve goes 9 radii deep, 5 beyond the 4 down to which such curves were "
      "compared with presses of a tip");
  EXPECT_EQ(doubts_of_depth(ball, some_puncture(1), 1.0), "");  // not known
  Puncture own = puncture;                                      // it was pressed itself
  own.tip_angle_rad = 0.0;
  EXPECT_EQ(doubts_of_depth({.name = "n", .radius_m = 7.5e-4}, own, 1.0), "");
}

TEST(Puncture, DoubtsAToughnessOfTearTests) {
  Puncture puncture = some_puncture(6);
  EXPECT_EQ(doubts_of(Puncture{}), "");
  EXPECT_EQ(doubts_of(puncture), "");
  puncture.toughness_j_per_m2[1] = 3000.0;
  EXPECT_EQ(doubts_of(puncture), "");
  puncture.toughness_j_per_m2[1] = 25000.0;
  EXPECT_EQ(doubts_of(puncture),
            "the toughness of muscle is 2.5e+04 J/m^2, above 3000: it is likely from "
            "tear tests, which give 15 to 27 times too much for a needle");
}

TEST(Puncture, DoubtsMembranesThatBearLessThanTheCut) {
  Puncture puncture = some_puncture(6);
  puncture.membrane_n[1] = 0.0;  // there is none
  EXPECT_EQ(doubts_of(puncture), "");
  puncture.membrane_n[1] = 0.1;
  EXPECT_EQ(doubts_of(puncture),
            "the membrane of muscle bears 0.1 N, less than its cutting force 0.2 N");
  puncture = some_puncture(6);
  puncture.rupture[2] = puncture.rupture[3] = 0.4;
  EXPECT_EQ(doubts_of(puncture),
            "2 ruptures bear less than the cutting force of the first layer");
  puncture.rule = "energy";
  EXPECT_EQ(doubts_of(puncture), "");
}

TEST(Puncture, IsTheSameOnlyWithTheSameNumbers) {
  const Puncture puncture = some_puncture(6);
  EXPECT_TRUE(same(puncture, some_puncture(6)));
  EXPECT_FALSE(same(puncture, some_puncture(1)));
  EXPECT_FALSE(same(puncture, Puncture{}));
  Puncture other = puncture;
  other.layer_depth_m(1, 2) = 0.02;  // NaN before
  EXPECT_FALSE(same(puncture, other));
  other = puncture;
  other.layer_material(0, 0) = 1;
  EXPECT_FALSE(same(puncture, other));
  other = puncture;
  other.mouth_m *= 2.0;
  EXPECT_FALSE(same(puncture, other));
  other = puncture;
  other.toughness_j_per_m2[2] = 1.0;
  EXPECT_FALSE(same(puncture, other));
  other = puncture;
  other.radius_m = 1e-3;
  EXPECT_FALSE(same(puncture, other));
  other = puncture;
  other.membrane_j = {1.0, 1.0, 1.0};
  EXPECT_FALSE(same(puncture, other));
}

TEST(Puncture, TheLastLayerIsThatOfTheNode) {
  const Puncture puncture = some_puncture(6);
  EXPECT_EQ(last_layer_m(puncture, 4), 0.01);
  EXPECT_EQ(last_layer_m(puncture, 1), puncture.layer_depth_m(1, 1));  // has two
  EXPECT_EQ(last_layer_m(some_puncture(1), 5), 0.01);
  Puncture stopped = some_puncture(1);
  stopped.membrane_n[1] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(last_layer_m(stopped, 0), stopped.layer_depth_m(0, 1));
  stopped.membrane_j = {kUnknownJ, 1.0, kUnknownJ};
  EXPECT_EQ(last_layer_m(stopped, 0), 0.01);  // an energy breaks it
}

TEST(Puncture, RowsOfNodesAreInTheirOrder) {
  const Puncture puncture = some_puncture(6);
  const std::vector<std::int32_t> nodes{4, 1};
  const Puncture part = rows_of(puncture, nodes);
  EXPECT_EQ(part.rupture,
            (std::vector<double>{puncture.rupture[4], puncture.rupture[1]}));
  EXPECT_EQ(part.layer_depth_m(0, 1), puncture.layer_depth_m(4, 1));
  EXPECT_EQ(part.layer_material(1, 2), -1);
  EXPECT_TRUE(same(rows_of(some_puncture(1), nodes), some_puncture(1)));
  // A body of one node keeps its row, too.
  const std::vector<std::int32_t> one{0};
  EXPECT_TRUE(same(rows_of(some_puncture(1), one), some_puncture(1)));
}

}  // namespace
}  // namespace palpate
