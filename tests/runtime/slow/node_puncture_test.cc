// What the fast process gets to know of a needle, scaled as forces are.
#include "runtime/slow/node_puncture.h"

#include <limits>

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kHard = std::numeric_limits<double>::infinity();

// Two nodes: skin over bone, and skin alone.
Puncture skin_over_bone() {
  Puncture p;
  p.rule = "force";
  p.material = {"skin", "bone"};
  p.membrane_n = {1.0, kHard};
  p.cutting_n = {0.4, kHard};
  p.friction_n_per_m = {8.0, 0.0};
  p.static_ratio = {1.2, 1.0};
  p.toughness_j_per_m2 = {400.0, kNone};
  p.shaft_n_per_m = 60.0;
  p.lateral_n_per_m2 = 3000.0;
  p.mouth_m = 5e-4;
  p.rupture = {1.0, 2.0};
  p.layer_depth_m.resize(2, 2);
  p.layer_depth_m << 0.0, 0.003, 0.0, kNone;
  p.layer_material.resize(2, 2);
  p.layer_material << 0, 1, 0, -1;
  return p;
}

TEST(NodePuncture, ForcesAndStiffnessesAreScaledAndRatiosAndLengthsAreNot) {
  const PunctureRules rules = puncture_rules(skin_over_bone(), 0.5);
  ASSERT_EQ(rules.materials, 2);
  EXPECT_EQ(check(rules), nullptr);
  EXPECT_EQ(rules.material[0].membrane_n, 0.5);
  EXPECT_EQ(rules.material[0].cutting_n, 0.2);
  EXPECT_EQ(rules.material[0].friction_n_per_m, 4.0);
  EXPECT_EQ(rules.material[0].static_ratio, 1.2);
  EXPECT_EQ(rules.material[1].membrane_n, kHard);
  EXPECT_LT(rules.material[0].membrane_j, 0.0);  // none
  EXPECT_EQ(rules.shaft_n_per_m, 30.0);
  EXPECT_EQ(rules.lateral_n_per_m2, 1500.0);
  EXPECT_EQ(rules.mouth_m, 5e-4);
  EXPECT_FALSE(rules.by_energy);
}

TEST(NodePuncture, EnergiesOfMembranesAreScaled) {
  Puncture puncture = skin_over_bone();
  puncture.membrane_j = {2e-3, kNone};
  const PunctureRules rules = puncture_rules(puncture, 0.5);
  EXPECT_EQ(check(rules), nullptr);
  EXPECT_EQ(rules.material[0].membrane_j, 1e-3);
  EXPECT_LT(rules.material[1].membrane_j, 0.0);
}

TEST(NodePuncture, ATipMeetsTheLayersOfItsOwnNode) {
  const Puncture puncture = skin_over_bone();
  const NodePuncture over_bone = node_puncture(puncture, 0, 0.5);
  EXPECT_EQ(over_bone.layers, 2);
  EXPECT_EQ(over_bone.rupture, 0.5);
  EXPECT_EQ(over_bone.depth_m[1], 0.003);
  EXPECT_EQ(over_bone.material[1], 1);
  const NodePuncture alone = node_puncture(puncture, 1, 0.5);
  EXPECT_EQ(alone.layers, 1);
  EXPECT_EQ(alone.rupture, 1.0);
}

TEST(NodePuncture, OneRowStandsForAllNodes) {
  Puncture puncture = rows_of(skin_over_bone(), 0, 1);
  EXPECT_EQ(node_puncture(puncture, 17, 1.0).layers, 2);
  EXPECT_EQ(node_puncture(puncture, 17, 1.0).rupture, 1.0);
}

TEST(NodePuncture, AToolThatIsNoNeedleHasNoRulesAndNoLayers) {
  EXPECT_EQ(puncture_rules({}, 1.0).materials, 0);
  EXPECT_EQ(node_puncture({}, 3, 1.0).layers, 0);
}

}  // namespace
}  // namespace palpate
