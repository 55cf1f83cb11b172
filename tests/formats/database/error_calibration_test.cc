// Stated errors: what a factor from a few checked nodes covers of all the others.
#include "formats/database/error_calibration.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(ErrorCalibration, CoveringIsTheSmallestThatCoversANewValueToo) {
  std::vector<double> values;
  for (int i = 40; i >= 1; --i) {
    values.push_back(i);
  }
  EXPECT_EQ(covering(values), 39.0);  // ceil(0.95 * 41)
  values.resize(19);                  // 40 to 22
  EXPECT_EQ(covering(values), 40.0);
  EXPECT_EQ(covering({0.5, 0.25}), 0.5);
}

TEST(ErrorCalibration, TakesTheRatioThatSoManyOthersStayBelow) {
  const std::vector<double> estimate(39, 0.02);
  std::vector<double> error;
  for (int i = 1; i <= 39; ++i) {
    error.push_back(0.001 * i);
  }
  // ceil(0.95 * 40) = 38: one ratio of 39 is above.
  EXPECT_DOUBLE_EQ(calibrate_errors(estimate, error), 0.038 / 0.02);
}

TEST(ErrorCalibration, NeverFallsBelowWhatIsTakenWithoutChecks) {
  EXPECT_EQ(calibrate_errors({}, {}), kLeastErrorFactor);
  for (const std::size_t checks : {1, 18, 24, 100}) {
    const std::vector<double> estimate(checks, 0.02);
    const std::vector<double> error(checks, 0.001);
    EXPECT_EQ(calibrate_errors(estimate, error), kLeastErrorFactor) << checks;
  }
}

TEST(ErrorCalibration, WithFewChecksTakesTheLargestRatio) {
  const std::vector<double> estimate(18, 0.02);
  std::vector<double> error(18, 0.001);
  error[7] = 0.2;
  EXPECT_DOUBLE_EQ(calibrate_errors(estimate, error), 10.0);
}

// A check that failed is beyond every number: it moves the rank, and where that reaches
// it the largest known ratio covers less.
TEST(ErrorCalibration, AFailedCheckCountsAsAMiss) {
  constexpr double kNobodyKnows = std::numeric_limits<double>::infinity();
  const std::vector<double> estimate(39, 0.02);
  std::vector<double> error;
  for (int i = 1; i <= 38; ++i) {
    error.push_back(0.001 * i);
  }
  error.push_back(kNobodyKnows);
  EXPECT_DOUBLE_EQ(calibrate_errors(estimate, error), 0.038 / 0.02);
  EXPECT_EQ(covered_share(38, 39), 0.95);
  error[5] = kNobodyKnows;
  EXPECT_DOUBLE_EQ(calibrate_errors(estimate, error), 0.038 / 0.02);
  EXPECT_DOUBLE_EQ(covered_share(37, 39), 37.0 / 40.0);
  EXPECT_DOUBLE_EQ(calibrate_errors(std::vector{0.02}, std::vector{kNobodyKnows}),
                   kLeastErrorFactor);
}

TEST(ErrorCalibration, FewChecksCoverWhatTheyCan) {
  EXPECT_EQ(covered_share(0, 0), 0.0);
  EXPECT_DOUBLE_EQ(covered_share(6, 6), 6.0 / 7.0);
  EXPECT_DOUBLE_EQ(covered_share(12, 12), 12.0 / 13.0);
  EXPECT_EQ(covered_share(19, 19), 0.95);
  EXPECT_EQ(covered_share(24, 24), 0.95);
}

// Errors that estimates know little of: log-normal ratios of any width, and estimates
// that say nothing at all. Coverage of new nodes must be 0.95 to 0.95 + 1/(n + 1).
TEST(ErrorCalibration, CoversNinetyFivePercentOfNodesThatWereNotChecked) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  for (const double width : {0.2, 0.8, 1.5}) {
    constexpr int kChecks = 24;
    constexpr int kBuilds = 4000;
    double covered = 0.0;
    for (int build = 0; build < kBuilds; ++build) {
      std::vector<double> estimate;
      std::vector<double> error;
      for (int i = 0; i <= kChecks; ++i) {
        estimate.push_back(std::exp(normal(random)));
        error.push_back(30.0 * estimate.back() * std::exp(width * normal(random)));
      }
      const double last_estimate = estimate.back();
      const double last_error = error.back();
      estimate.pop_back();
      error.pop_back();
      const double factor = calibrate_errors(estimate, error);
      covered += last_error <= factor * last_estimate ? 1.0 : 0.0;
    }
    covered /= kBuilds;
    // ceil(0.95 * 25) / 25 = 0.96; the deviation of 4000 draws is 0.0031.
    EXPECT_NEAR(covered, 0.96, 0.0125) << width;
  }
}

}  // namespace
}  // namespace palpate
