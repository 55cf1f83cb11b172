// A channel alone: layers, friction, springs, and that none of it gives energy.
#include "runtime/needle/channel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/layered_body.h"

namespace palpate {
namespace {

constexpr Real kChannelTickS = 0.0005;

Channel straight_channel(Real depth_m, std::int32_t layer) {
  Channel channel;
  channel.axis = Vector3::UnitZ();
  channel.layers = layered_node(kSkinN);
  channel.depth_m = depth_m;
  channel.layer = layer;
  return channel;
}

Vector3 at_depth(Real z) {
  return {0.0, 0.0, -z};
}

TEST(Channel, TheImageIsTheTipMovedBackByTheDepth) {
  const Channel channel = straight_channel(0.008, 1);
  EXPECT_DOUBLE_EQ(channel.tip_m(at_depth(0.01)), 0.01);
  EXPECT_LT((channel.image_m(at_depth(0.01)) - at_depth(0.002)).norm(), 1e-15);
  // What lies across the axis is not in the image: the shaft holds it.
  const Vector3 aside(0.003, -0.001, -0.01);
  EXPECT_LT((channel.image_m(aside) - at_depth(0.002)).norm(), 1e-15);
}

TEST(Channel, YieldsByItsLayerAndAtABoundaryByTheMembrane) {
  const PunctureRules rules = layered_rules();
  Channel channel = straight_channel(0.002, 0);
  EXPECT_EQ(boundary_m(channel), 0.002);
  EXPECT_EQ(cutting_n(rules, channel), 0.5);
  EXPECT_FALSE(breaks(rules, channel, 0.6, 1.0));
  EXPECT_TRUE(breaks(rules, channel, 0.601, 0.0));
  channel.layer = 1;
  EXPECT_EQ(cutting_n(rules, channel), 0.2);
  EXPECT_FALSE(breaks(rules, channel, 1.5, 1.0));
  channel = straight_channel(0.03, 2);
  EXPECT_EQ(boundary_m(channel), std::numeric_limits<Real>::infinity());
  EXPECT_EQ(cutting_n(rules, channel), 0.4);
}

TEST(Channel, AMembraneWithAnEnergyAsksNoForce) {
  PunctureRules rules = layered_rules();
  rules.material[1].membrane_j = 2e-3;
  Channel channel = straight_channel(0.002, 0);
  EXPECT_EQ(check(rules), nullptr);
  EXPECT_FALSE(breaks(rules, channel, 100.0, 2e-3));
  EXPECT_TRUE(breaks(rules, channel, 0.1, 2.001e-3));
  channel.layer = 1;  // the next has none
  EXPECT_TRUE(breaks(rules, channel, 1.501, 0.0));
  EXPECT_FALSE(breaks(rules, channel, 1.499, 1.0));
  rules.material[1].membrane_j = std::numeric_limits<Real>::infinity();
  EXPECT_NE(check(rules), nullptr);
}

TEST(Channel, FrictionIsTheSumOverItsLayers) {
  const PunctureRules rules = layered_rules();
  Channel channel = straight_channel(0.02, 2);
  channel.inserted_m = 0.015;
  const ShaftFriction friction = friction_of(rules, channel);
  const Real sum = 20.0 * 0.002 + 10.0 * 0.010 + 15.0 * 0.003;
  EXPECT_NEAR(friction.kinetic_n, sum, 1e-14);
  EXPECT_NEAR(friction.static_n, kStaticRatio * sum, 1e-14);
  channel.inserted_m = 0.001;
  EXPECT_NEAR(friction_of(rules, channel).kinetic_n, 20.0 * 0.001, 1e-15);
  channel.inserted_m = 0.0;
  EXPECT_EQ(friction_of(rules, channel).kinetic_n, 0.0);
}

TEST(Channel, SticksToItsStaticLimitSlipsAtTheKineticAndSticksAgain) {
  const PunctureRules rules = layered_rules();
  Channel channel = straight_channel(0.02, 2);
  settle(rules, channel, 0.015, kChannelTickS);
  const auto [kinetic_n, static_n] = friction_of(rules, channel);
  const Real most_m = static_n / rules.shaft_n_per_m;
  move(channel, at_depth(0.999 * most_m));
  settle(rules, channel, 0.015, kChannelTickS);
  EXPECT_FALSE(channel.slips);
  EXPECT_NEAR(held_n(rules, channel).z(), 0.999 * static_n, 1e-12);
  move(channel, at_depth(0.002 * most_m));
  settle(rules, channel, 0.015, kChannelTickS);
  EXPECT_TRUE(channel.slips);
  EXPECT_NEAR(held_n(rules, channel).z(), kinetic_n, 1e-12);
  for (Real t = 0.0; t <= kShaftRestS; t += kChannelTickS) {
    settle(rules, channel, 0.015, kChannelTickS);
  }
  EXPECT_FALSE(channel.slips);
}

TEST(Channel, ANeedleThatLeavesIsHeldByNothing) {
  const PunctureRules rules = layered_rules();
  Channel channel = straight_channel(0.02, 2);
  settle(rules, channel, 0.015, kChannelTickS);
  move(channel, Vector3(1e-4, 2e-4, -1e-4));
  EXPECT_GT(held_j(rules, channel), 0.0);
  settle(rules, channel, -1e-6, kChannelTickS);
  EXPECT_EQ(held_j(rules, channel), 0.0);
  let_go(channel);
  EXPECT_EQ(held_n(rules, channel).norm(), 0.0);
}

// The force is the gradient of the energy; settling never raises it.
TEST(Channel, ForcesAreGradientsAndSettlingLosesEnergy) {
  const PunctureRules rules = layered_rules();
  std::mt19937 random(3);
  std::normal_distribution<double> noise;
  Channel channel = straight_channel(0.02, 2);
  Real z = 0.01;
  for (int n = 0; n < 20000; ++n) {
    const Vector3 step = 1e-4 * Vector3(noise(random), noise(random), noise(random));
    const Real before_j = held_j(rules, channel);
    const Vector3 before_n = held_n(rules, channel);
    move(channel, step);
    // Quadratic: the mean force does the work, exactly.
    const Real work_j = -0.5 * (before_n + held_n(rules, channel)).dot(step);
    ASSERT_NEAR(held_j(rules, channel) - before_j, work_j, 1e-15);
    z = std::clamp<Real>(z - step.z(), -0.002, 0.025);
    const Real moved_j = held_j(rules, channel);
    settle(rules, channel, z, kChannelTickS);
    ASSERT_LE(held_j(rules, channel), moved_j * (1.0 + 1e-14));
  }
}

TEST(Channel, ShaftForceAcrossStaysWhenItGoesDeeper) {
  const PunctureRules rules = layered_rules();
  Channel channel = straight_channel(0.02, 2);
  settle(rules, channel, 0.005, kChannelTickS);
  move(channel, Vector3(2e-4, 0.0, 0.0));
  const Vector3 before_n = held_n(rules, channel);
  settle(rules, channel, 0.015, kChannelTickS);
  EXPECT_LT((held_n(rules, channel) - before_n).norm(), 1e-15);
  settle(rules, channel, 0.005, kChannelTickS);
  EXPECT_LT(held_n(rules, channel).norm(), 0.34 * before_n.norm());
}

}  // namespace
}  // namespace palpate
