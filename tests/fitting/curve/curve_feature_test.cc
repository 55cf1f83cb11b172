#include "fitting/curve/curve_feature.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace {

// [N] over 5 mm, noise 2 mN.
std::vector<CurveFeature> features(const std::function<double(double)>& force_n) {
  std::vector<double> depth, force;
  for (int i = 0; i <= 200; ++i) {
    depth.push_back(5e-3 * i / 200);
    force.push_back(force_n(i / 200.0));
  }
  return find_features(depth, force, 2e-3);
}

TEST(CurveFeature, APunctureIsAFallAndNoPlateau) {
  const auto found = features([](double d) {
    return d < 0.6 ? d : 0.4 * d;
  });
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, FeatureKind::kFall);
  EXPECT_NEAR(found[0].change, 0.36, 0.01);
  EXPECT_NEAR(found[0].depth_m, 3e-3, 0.05e-3);
}

TEST(CurveFeature, AForceThatStaysAfterAFallIsAPlateauToo) {
  const auto found = features([](double d) {
    return d < 0.5 ? d : 0.2;
  });
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[1].kind, FeatureKind::kPlateau);
  EXPECT_NEAR(found[1].depth_m, 2.5e-3, 0.1e-3);
  EXPECT_NEAR(found[1].change, 0.0, 0.01);
}

TEST(CurveFeature, AKneeIsToldWhereNothingElseIs) {
  const auto found = features([](double d) {
    return d < 0.5 ? d : 0.5 + 0.3 * (d - 0.5);
  });
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, FeatureKind::kKnee);
  EXPECT_TRUE(features([](double d) {
                return d * d;
              }).empty());
}

// A rise with noise up to a limit.
std::optional<CurveFeature> clipped(double limit_n, double step_n) {
  std::mt19937 generator(3);
  std::normal_distribution<double> noise(0.0, 2e-3);
  std::vector<double> x, force;
  for (int i = 0; i < 200; ++i) {
    x.push_back(5e-3 * i / 200);
    force.push_back(std::min(limit_n, i / 200.0 + noise(generator)));
    force.back() =
        step_n > 0.0 ? step_n * std::round(force.back() / step_n) : force.back();
  }
  return find_clipped_force(x, force);
}

TEST(ClippedForce, StandsAtOneReadingThatNoneElseRepeats) {
  const auto found = clipped(0.7, 0.0);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->depth_m, 3.5e-3, 0.1e-3);
  EXPECT_EQ(found->depth_end_m, 5e-3 * 199 / 200);
  EXPECT_EQ(found->change, 0.7);
  EXPECT_FALSE(clipped(2.0, 0.0));
  EXPECT_FALSE(clipped(0.7, 0.1));  // a coarse reading stands everywhere
}

}  // namespace
}  // namespace palpate
