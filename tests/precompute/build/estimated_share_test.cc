#include "precompute/build/estimated_share.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(ShareAbove, IsHalfAtTheGeometricMean) {
  const std::vector<double> values{0.01, 0.04};
  EXPECT_NEAR(share_above(values, 0.02), 0.5, 1e-12);
}

TEST(ShareAbove, IsTheNormalTailOfLogarithms) {
  // Deviation of {-1, 1} is sqrt(2): one deviation above the mean leaves 15.87 %.
  const std::vector<double> values{std::exp(-1.0), std::exp(1.0)};
  EXPECT_NEAR(share_above(values, std::exp(std::sqrt(2.0))), 0.158655, 1e-6);
}

TEST(ShareAbove, ComesNearTheCountOfManyLogNormalValues) {
  std::mt19937 random(1);
  std::lognormal_distribution<double> draw(std::log(0.02), 0.5);
  std::vector<double> values(4000);
  double above = 0.0;
  for (double& value : values) {
    value = draw(random);
    above += value > 0.05 ? 1.0 / 4000.0 : 0.0;
  }
  // The count itself scatters by sqrt(0.033 / 4000) = 0.003.
  EXPECT_NEAR(share_above(values, 0.05), above, 0.01);
}

TEST(ShareAbove, NothingIsKnownFromOneValue) {
  EXPECT_EQ(share_above(std::vector<double>{9.0}, 1.0), 0.0);
  EXPECT_EQ(share_above(std::vector<double>{9.0, 0.0, -1.0}, 1.0), 0.0);
}

}  // namespace
}  // namespace palpate
