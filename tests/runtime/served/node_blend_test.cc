#include "runtime/served/node_blend.h"

#include <cmath>

#include <gtest/gtest.h>

#include "runtime/bench/bench_body.h"

namespace palpate {
namespace {

constexpr double kReachM = 0.004;

// A node at the origin, outward along z. @param tilt_rad of its direction.
ElementNode node(double force_n, double depth_m, double touch_m, double tilt_rad,
                 int samples = 17) {
  ElementNode node;
  node.node = 3;
  node.normal = {0.0, 0.0, 1.0};
  node.direction = {std::sin(tilt_rad), 0.0, std::cos(tilt_rad)};
  node.touch_offset_m = touch_m;
  if (force_n > 0.0) {
    set_power_law(node, 1.5, force_n, depth_m, samples);
  } else {
    node.direction = {0.0, 0.0, 0.0};
    node.touch_offset_m = 0.0;
  }
  return node;
}

// Force along the normal at a penetration.
double g(const ElementNode& node, double at_m) {
  const double c = std::abs(node.direction[2]);
  return node.samples == 0
             ? 0.0
             : c * node.curve().at(c * (at_m - node.touch_offset_m)).force_n;
}

double energy(const ElementNode& node, double at_m) {
  const double c = std::abs(node.direction[2]);
  return node.samples == 0 ? 0.0
                           : node.curve().at(c * (at_m - node.touch_offset_m)).energy_j;
}

// Steps until it arrives, and holds every step to the bound.
int steps_within(const ElementNode& from, const ElementNode& to, double most_n,
                 double slack_n) {
  NodeBlend blend(from, to, kReachM);
  ElementNode before = from;
  int steps = 0;
  for (; !blend.arrived() && steps < 1000; ++steps) {
    const ElementNode& now = blend.step(most_n);
    for (int k = 0; k <= 200; ++k) {
      const double at_m = -1e-3 + 9e-3 * k / 200.0;
      EXPECT_LE(std::abs(g(now, at_m) - g(before, at_m)),
                most_n / std::sqrt(2.0) + slack_n)
          << "step " << steps << ", " << at_m << " m";
      EXPECT_LE(std::abs(energy(now, at_m) - energy(before, at_m)) / kReachM,
                most_n / std::sqrt(8.0) + slack_n);
    }
    before = now;
  }
  EXPECT_EQ(before.samples, to.samples);
  EXPECT_EQ(before.force_n, to.force_n);
  EXPECT_EQ(before.direction, to.direction);
  return steps;
}

TEST(NodeBlend, MovesByNoMoreThanTheBoundAndArrivesAtTheNewResponse) {
  // What the 48 common knots and the bend where the later curve begins may miss: 1e-3
  // of the largest force.
  constexpr double kSlackN = 4e-3;
  const ElementNode soft = node(1.0, 0.006, 0.0, 0.0);
  const ElementNode stiff = node(4.0, 0.008, 2e-4, 0.3, 23);
  EXPECT_GE(steps_within(soft, stiff, 0.2, kSlackN), 10);
  EXPECT_GE(steps_within(stiff, soft, 0.2, kSlackN), 10);
  EXPECT_EQ(steps_within(soft, node(1.01, 0.006, 0.0, 0.0), 0.2, kSlackN), 1);
}

TEST(NodeBlend, RisesFromNoResponseAndFallsToIt) {
  const ElementNode none = node(0.0, 0.0, 0.0, 0.0);
  const ElementNode stiff = node(4.0, 0.008, 2e-4, 0.3);
  // Its energy is 4 N x 8 mm / 2.5, over the reach and by sqrt 8: 22.6 bounds.
  EXPECT_EQ(steps_within(none, stiff, 0.4, 1e-9), 23);
  EXPECT_EQ(steps_within(stiff, none, 0.4, 1e-9), 23);
  EXPECT_EQ(NodeBlend(none, none, kReachM).arrived(), true);
}

TEST(NodeBlend, NothingOnTheWayIsBelowZero) {
  // Both begin with a slope, one 0.3 mm after the other.
  ElementNode early = node(1.0, 0.006, -1e-4, 0.0);
  ElementNode late = node(4.0, 0.006, 2e-4, 0.2);
  set_power_law(early, 1.0, 1e-3, 0.006);
  set_power_law(late, 1.0, 4.0, 0.006);
  for (const bool forth : {true, false}) {
    NodeBlend blend(forth ? early : late, forth ? late : early, kReachM);
    while (!blend.arrived()) {
      const ElementNode now = blend.step(0.3);
      for (int k = 0; k <= 2000; ++k) {
        const double at_m = -2e-4 + 1e-3 * k / 2000.0;
        ASSERT_GE(g(now, at_m), 0.0) << at_m << " m, " << blend.share();
        ASSERT_GE(energy(now, at_m), 0.0);
      }
    }
  }
}

TEST(NodeBlend, EnergyIsTheIntegralOfForceOnTheWay) {
  NodeBlend blend(node(1.0, 0.006, -3e-4, 0.1), node(4.0, 0.008, 2e-4, 0.3, 29),
                  kReachM);
  const ElementNode now = blend.step(0.7);
  ASSERT_FALSE(blend.arrived());
  const ElementCurve curve = now.curve();
  double summed_j = 0.0;
  constexpr int kParts = 200000;
  const double h = 1.2 * curve.depth_max_m() / kParts;
  for (int k = 0; k < kParts; ++k) {
    summed_j += h * curve.at((k + 0.5) * h).force_n;
  }
  // The midpoint rule errs by h^2 f' / 24: 1e-13 J.
  EXPECT_NEAR(curve.at(1.2 * curve.depth_max_m()).energy_j, summed_j, 1e-11);
}

TEST(NodeBlend, FarTooManySamplesAreThinnedToWhatAMessageHolds) {
  const ElementNode soft = node(1.0, 0.006, 0.0, 0.0, 47);
  const ElementNode stiff = node(2.0, 0.0061, 1e-4, 0.2, 48);
  NodeBlend blend(soft, stiff, kReachM);
  const ElementNode half = blend.step(0.5);
  EXPECT_EQ(half.samples, static_cast<std::int32_t>(kElementSamples));
  const double s = blend.share();
  for (int k = 1; k <= 50; ++k) {
    const double at_m = 6e-3 * k / 50.0;
    EXPECT_NEAR(g(half, at_m), (1.0 - s) * g(soft, at_m) + s * g(stiff, at_m), 2e-3);
  }
}

}  // namespace
}  // namespace palpate
