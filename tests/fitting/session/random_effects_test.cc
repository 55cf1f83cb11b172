#include "fitting/session/random_effects.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace {

using Values = std::vector<double>;
using Data = std::vector<std::vector<Values>>;

// Variance of a list about its mean.
double variance(const Values& values) {
  double mean = 0.0, squares = 0.0;
  for (const double v : values) {
    mean += v / static_cast<double>(values.size());
  }
  for (const double v : values) {
    squares += (v - mean) * (v - mean);
  }
  return squares / static_cast<double>(values.size() - 1);
}

TEST(RandomEffects, OfABalancedDesignIsTheAnalysisOfVariance) {
  // 4 specimens, one point each, 3 repeats: mean squares between and within.
  const Data y{{{10, 12, 11}}, {{15, 14, 16}}, {{9, 8, 10}}, {{13, 12, 14}}};
  const RandomEffects e = random_effects(y);
  const double within = 1.0;                               // each group's variance is 1
  const double between = 3.0 * variance({11, 15, 9, 13});  // 3 * 20/3
  EXPECT_NEAR(e.repeat_sd, std::sqrt(within), 1e-12);
  EXPECT_NEAR(e.specimen_sd, std::sqrt((between - within) / 3.0), 1e-12);
  EXPECT_TRUE(std::isnan(e.point_sd));
  EXPECT_NEAR(e.mean, 12.0, 1e-12);
  EXPECT_NEAR(e.mean_sd, std::sqrt(between / 12.0), 1e-12);
  EXPECT_EQ(e.degrees_of_freedom, 3.0);
  EXPECT_NEAR(e.upper - e.mean, 3.182446 * e.mean_sd, 1e-5);  // t of 3 at 97.5 %
}

TEST(RandomEffects, OfANestedBalancedDesignIsTheAnalysisOfVariance) {
  // 3 specimens of 2 points of 2 repeats.
  const Data y{{{1, 3}, {6, 8}}, {{10, 14}, {11, 13}}, {{20, 21}, {27, 28}}};
  const RandomEffects e = random_effects(y);
  const double repeats = (2.0 + 2.0 + 8.0 + 2.0 + 0.5 + 0.5) / 6.0;
  const double points =
      2.0 * (variance({2, 7}) + variance({12, 12}) + variance({20.5, 27.5})) / 3.0;
  const double specimens = 4.0 * variance({4.5, 12, 24});
  EXPECT_NEAR(e.repeat_sd, std::sqrt(repeats), 1e-12);
  EXPECT_NEAR(e.point_sd, std::sqrt((points - repeats) / 2.0), 1e-12);
  EXPECT_NEAR(e.specimen_sd, std::sqrt((specimens - points) / 4.0), 1e-12);
}

TEST(RandomEffects, VariancesOfAnUnbalancedDesignAreRightInTheMean) {
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  double repeat = 0.0, point = 0.0, observed = 0.0;
  constexpr int kRuns = 4000;
  for (int run = 0; run < kRuns; ++run) {
    Data y;
    for (const auto& counts : {std::vector<int>{1, 4}, {2, 2, 5}, {3}, {1, 1, 1, 6}}) {
      const double specimen = 20.0 + 5.0 * normal(generator);
      auto& points = y.emplace_back();
      for (const int count : counts) {
        const double at = specimen + 2.0 * normal(generator);
        auto& values = points.emplace_back();
        for (int k = 0; k < count; ++k) {
          values.push_back(at + normal(generator));
        }
      }
    }
    const RandomEffects e = random_effects(y);
    repeat += e.repeat_sd * e.repeat_sd / kRuns;
    point += e.point_sd * e.point_sd / kRuns;
    observed += e.specimen_sd * e.specimen_sd / kRuns;
  }
  EXPECT_NEAR(repeat, 1.0, 0.03);
  EXPECT_NEAR(point, 4.0, 0.15);
  EXPECT_NEAR(observed, 25.0, 1.2);
}

TEST(RandomEffects, SaysNothingOfWhatIsNotRepeated) {
  const RandomEffects one = random_effects({{{3.0}}});
  EXPECT_EQ(one.mean, 3.0);
  EXPECT_TRUE(std::isnan(one.mean_sd));
  EXPECT_TRUE(std::isnan(one.lower));
  EXPECT_TRUE(std::isnan(one.repeat_sd));
  const RandomEffects two = random_effects({{{3.0}}, {{5.0}}});
  EXPECT_TRUE(std::isnan(two.repeat_sd));
  EXPECT_NEAR(two.specimen_sd, std::sqrt(2.0), 1e-12);
}

TEST(RandomEffects, AVarianceIsNeverNegative) {
  // Repeats scatter, their means do not.
  const RandomEffects e = random_effects({{{1, 9}}, {{2, 8}}, {{5, 5}}});
  EXPECT_EQ(e.specimen_sd, 0.0);
}

}  // namespace
}  // namespace palpate
