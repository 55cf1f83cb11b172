#include "formats/response/puncture.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/punctured_sphere.h"

namespace palpate {
namespace {

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
}

TEST(Puncture, TheLastLayerIsThatOfTheNode) {
  const Puncture puncture = some_puncture(6);
  EXPECT_EQ(last_layer_m(puncture, 4), 0.01);
  EXPECT_EQ(last_layer_m(puncture, 1), puncture.layer_depth_m(1, 1));  // has two
  EXPECT_EQ(last_layer_m(some_puncture(1), 5), 0.01);
  Puncture stopped = some_puncture(1);
  stopped.membrane_n[1] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(last_layer_m(stopped, 0), stopped.layer_depth_m(0, 1));
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
