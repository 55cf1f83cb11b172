// Ratios of full and linear presses: what they reproduce, and between which vertices.
#include "precompute/press/response_ratio.h"

#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// F = k d along z, turned about y by `turn` [rad] per metre.
Indentation path(double k_n_per_m, double turn_per_m = 0.0, double depth_m = 0.01) {
  Indentation path;
  for (int i = 0; i <= 10; ++i) {
    const double d = depth_m * i / 10.0;
    path.sample.push_back({.penetration_m = 0.001 + d,
                           .force_n = k_n_per_m * d *
                                      Eigen::Vector3d(std::sin(turn_per_m * d), 0.0,
                                                      std::cos(turn_per_m * d))});
  }
  return path;
}

TEST(PathRatio, MakesTheGoodPathOutOfTheCheapOne) {
  const Indentation full = path(130.0, 20.0);
  const Indentation linear = path(100.0);
  const auto ratio = path_ratio(full, linear);
  ASSERT_TRUE(ratio);
  const Indentation made = scaled(linear, *ratio, kInfinity);
  ASSERT_EQ(made.sample.size(), full.sample.size());
  for (std::size_t k = 0; k < full.sample.size(); ++k) {
    EXPECT_LT((made.sample[k].force_n - full.sample[k].force_n).norm(), 1e-12);
    EXPECT_DOUBLE_EQ(made.sample[k].penetration_m, full.sample[k].penetration_m);
  }
}

TEST(PathRatio, CarriesOverToAnotherMeshOfTheSameVertex) {
  // A coarse mesh makes both presses 7 % too stiff; the fine linear one is right.
  const auto ratio = path_ratio(path(1.07 * 130.0, 20.0), path(1.07 * 100.0));
  ASSERT_TRUE(ratio);
  const Indentation made = scaled(path(100.0), *ratio, kInfinity);
  const Indentation full = path(130.0, 20.0);
  for (std::size_t k = 0; k < full.sample.size(); ++k) {
    EXPECT_LT((made.sample[k].force_n - full.sample[k].force_n).norm(), 1e-12);
  }
}

TEST(PathRatio, EndsWhereTheForcePassesTheLargest) {
  const auto ratio = path_ratio(path(200.0), path(100.0));
  ASSERT_TRUE(ratio);
  const Indentation made = scaled(path(100.0), *ratio, 1.1);
  EXPECT_TRUE(made.force_capped);
  EXPECT_NEAR(made.sample.back().force_n.norm(), 1.2, 1e-12);
  EXPECT_FALSE(made.ends_early);
}

// A linear press that ended at its own largest force says nothing beyond.
TEST(PathRatio, SaysThatItEndsWhereTheCheapPathWasCapped) {
  const auto ratio = path_ratio(path(50.0), path(100.0));
  ASSERT_TRUE(ratio);
  Indentation linear = path(100.0);
  EXPECT_FALSE(scaled(linear, *ratio, 10.0).ends_early);
  linear.force_capped = true;
  const Indentation made = scaled(linear, *ratio, 10.0);
  EXPECT_TRUE(made.ends_early);
  EXPECT_FALSE(made.force_capped);
  EXPECT_FALSE(scaled(linear, *ratio, 0.3).ends_early);
}

}  // namespace
}  // namespace palpate
