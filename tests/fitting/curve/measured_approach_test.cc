#include "fitting/curve/measured_approach.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "fitting/numerics/robust_statistics.h"
#include "formats/base/error.h"
#include "tests/support/synthetic_curve.h"

namespace palpate {
namespace {

bool has(const Approach& approach, FitFlag flag) {
  return std::count(approach.flags.begin(), approach.flags.end(), flag) == 1;
}

void turn(std::vector<double>& values) {
  std::transform(values.begin(), values.end(), values.begin(), std::negate<>());
}

// Goes back along the same displacements with `share` of the press's force.
Measurement loop(double share) {
  Measurement m = synthetic({}, 1);
  for (std::size_t i = m.depth_m.size(); i-- > 0;) {
    m.depth_m.push_back(m.depth_m[i]);
    m.force_n.push_back(share * m.force_n[i]);
  }
  return m;
}

TEST(RobustStatistics, AreThoseOfSmallSets) {
  EXPECT_EQ(median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median({4.0, 1.0, 2.0, 3.0}), 2.5);
  EXPECT_TRUE(std::isnan(median({})));
  EXPECT_DOUBLE_EQ(robust_standard_deviation({0.0, 1.0, 2.0, 3.0, 1e9}), 1.4826);
  EXPECT_EQ(running_median(std::vector<double>{1.0, 2.0, 9.0, 3.0, 4.0}, 1),
            (std::vector<double>{1.0, 2.0, 3.0, 4.0, 4.0}));
}

// 350 values: the median deviation scatters by 8 %; the largest force is 200 times it.
TEST(RobustStatistics, NoiseIsThatOfTheSensorNotOfTheCurve) {
  EXPECT_NEAR(noise_standard_deviation(synthetic({}, 1).force_n), 0.005, 0.0012);
}

TEST(Approach, KeepsAPlainPressUpToItsLargestDisplacement) {
  const Measurement m = synthetic({}, 1);
  const Approach approach = select_approach(m);
  EXPECT_TRUE(approach.flags.empty());
  EXPECT_EQ(approach.displacement_m, m.depth_m);
  EXPECT_EQ(approach.force_n, m.force_n);
}

TEST(Approach, CutsHoldAndRetractAndCountsThem) {
  Measurement m = loop(0.8);
  const double deepest = m.depth_m[349];
  m.depth_m.insert(m.depth_m.begin() + 350, 40, deepest);
  m.force_n.insert(m.force_n.begin() + 350, 40, 0.9);
  const Approach approach = select_approach(m);
  EXPECT_EQ(approach.force_n.size(), 350U);
  EXPECT_EQ(approach.hold_samples, 41U);  // the release's first sample is one
  EXPECT_EQ(approach.retract_samples, 349U);
  EXPECT_TRUE(has(approach, FitFlag::kHoldCutOff));
  EXPECT_TRUE(has(approach, FitFlag::kRetractCutOff));
  EXPECT_FALSE(has(approach, FitFlag::kNonPassiveLoop));
}

TEST(Approach, AForceThatRisesInTheHoldIsNone) {
  Measurement m = synthetic({}, 3);
  EXPECT_FALSE(has(select_approach(m), FitFlag::kForceRisesInHold));
  for (double& depth : m.depth_m) {
    depth = std::min(depth, 5e-3);  // of 7 mm
  }
  const Approach clipped = select_approach(m);
  EXPECT_TRUE(has(clipped, FitFlag::kHoldCutOff));
  EXPECT_TRUE(has(clipped, FitFlag::kForceRisesInHold));
  EXPECT_FALSE(has(select_approach(loop(0.8)), FitFlag::kForceRisesInHold));
}

TEST(Approach, LoopWorkIsTheIntegralOfForce) {
  const Approach approach = select_approach(loop(0.8));
  // Integral of (x/5 mm)^1.5 N over 5 mm; the noise's work has a deviation of 2 uJ.
  EXPECT_NEAR(approach.press_work_j, 5e-3 / 2.5, 6e-6);
  EXPECT_NEAR(approach.release_work_j, 0.8 * approach.press_work_j, 1e-12);
}

TEST(Approach, FlagsALoopThatGivesMoreThanItTook) {
  EXPECT_TRUE(has(select_approach(loop(1.01)), FitFlag::kNonPassiveLoop));
  EXPECT_FALSE(has(select_approach(loop(1.0)), FitFlag::kNonPassiveLoop));
}

TEST(Approach, TurnsSignsAndSaysSo) {
  const Measurement right = synthetic({}, 1);
  Measurement m = right;
  turn(m.depth_m);
  turn(m.force_n);
  const Approach approach = select_approach(m);
  EXPECT_EQ(approach.displacement_m, right.depth_m);
  EXPECT_EQ(approach.force_n, right.force_n);
  EXPECT_TRUE(has(approach, FitFlag::kDepthSignTurned));
  EXPECT_TRUE(has(approach, FitFlag::kForceSignTurned));
}

TEST(Approach, LeavesASpikeOut) {
  Measurement m = synthetic({}, 1);
  m.force_n[100] += 50.0;
  m.force_n[250] -= 0.3;
  const Approach approach = select_approach(m);
  EXPECT_EQ(approach.spikes, 2U);
  EXPECT_TRUE(has(approach, FitFlag::kSpikes));
  EXPECT_LT(*std::max_element(approach.force_n.begin(), approach.force_n.end()), 1.1);
}

TEST(Approach, AStepOfTheForceIsNoSpike) {
  Measurement m = synthetic({}, 1);
  for (std::size_t i = 120; i < m.force_n.size(); ++i) {
    m.force_n[i] += 2.0;
  }
  EXPECT_EQ(select_approach(m).spikes, 0U);
}

TEST(Approach, FlagsDepthThatGoesBack) {
  Measurement m = synthetic({}, 1);
  m.depth_m[100] -= 0.5e-3;
  EXPECT_TRUE(has(select_approach(m), FitFlag::kNonMonotoneDepth));
}

TEST(Approach, KeepsToTheRange) {
  const Approach approach = select_approach(synthetic({}, 1), {1e-3, 3e-3});
  EXPECT_GE(approach.displacement_m.front(), 1e-3);
  EXPECT_LE(approach.displacement_m.back(), 3e-3);
  EXPECT_EQ(approach.out_of_range + approach.force_n.size(), 350U);
}

TEST(Approach, RefusesWhatCannotBeFitted) {
  const Measurement m = synthetic({}, 1);
  EXPECT_THROW((void)select_approach(m, {3e-3, 1e-3}), InputError);
  EXPECT_THROW((void)select_approach(m, {1.00e-3, 1.01e-3}), InputError);
  EXPECT_THROW((void)select_approach(synthetic({.samples = 7}, 1)), InputError);
  Measurement bad = m;
  bad.force_n[3] = std::nan("");
  EXPECT_THROW((void)select_approach(bad), InputError);
  bad = m;
  bad.force_n.pop_back();
  EXPECT_THROW((void)select_approach(bad), InputError);
  bad = m;
  std::fill(bad.depth_m.begin(), bad.depth_m.end(), 1e-3);
  EXPECT_THROW((void)select_approach(bad), InputError);
}

}  // namespace
}  // namespace palpate
