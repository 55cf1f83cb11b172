#include "runtime/realtime/step_histogram.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(StepHistogram, PercentilesAreWithinABinAboveTheTrueOnes) {
  std::mt19937 generator(3);
  std::lognormal_distribution<double> duration(6.0, 2.0);
  StepHistogram histogram;
  std::vector<double> all;
  for (int i = 0; i < 20'000; ++i) {
    all.push_back(std::floor(duration(generator)));
    histogram.add(static_cast<std::int64_t>(all.back()));
  }
  std::sort(all.begin(), all.end());
  EXPECT_EQ(histogram.count(), all.size());
  EXPECT_EQ(histogram.max_ns(), all.back());
  for (const double fraction : {0.01, 0.5, 0.99, 0.999, 1.0}) {
    const auto rank = static_cast<std::size_t>(std::ceil(fraction * 20'000.0)) - 1;
    EXPECT_GE(histogram.percentile_ns(fraction), all[rank]);
    EXPECT_LE(histogram.percentile_ns(fraction), all[rank] * (1.0 + 1.0 / 16.0) + 1.0);
  }
}

TEST(StepHistogram, IsZeroWithoutStepsAndTakesTheExtremes) {
  StepHistogram histogram;
  EXPECT_EQ(histogram.percentile_ns(0.5), 0.0);
  histogram.add(-5);
  EXPECT_EQ(histogram.percentile_ns(1.0), 0.0);
  histogram.add(INT64_MAX);
  EXPECT_EQ(histogram.count(), 2U);
  EXPECT_EQ(histogram.max_ns(), static_cast<double>(INT64_MAX));
}

}  // namespace
}  // namespace palpate
