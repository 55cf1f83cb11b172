#include "fitting/numerics/robust_statistics.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(WithoutOutliers, LeavesOutGlitchesAndKeepsShapes) {
  std::vector<double> residuals(200, 0.5);
  residuals[10] = 9.0;                                   // one
  residuals[20] = residuals[21] = residuals[22] = -9.0;  // three in a row
  residuals[30] = residuals[31] = 9.0;                   // two each side
  residuals[32] = residuals[33] = -9.0;
  for (std::size_t i = 40; i < 44; ++i) {
    residuals[i] = 9.0;  // four in a row: no glitch
  }
  const std::vector<std::size_t> kept = without_outliers(residuals, 1.0);
  EXPECT_EQ(kept.size(), 200U - 8U);
  for (const std::size_t out : {10, 20, 21, 22, 30, 31, 32, 33}) {
    EXPECT_FALSE(std::binary_search(kept.begin(), kept.end(), out)) << out;
  }
  EXPECT_TRUE(std::binary_search(kept.begin(), kept.end(), 41U));
}

TEST(WithoutOutliers, KeepsAllWhereTheLawFails) {
  std::vector<double> residuals(100, 0.0);
  for (std::size_t i = 0; i < 10; ++i) {
    residuals[10 * i] = 5.0;
  }
  EXPECT_EQ(without_outliers(residuals, 1.0).size(), 100U);
  EXPECT_TRUE(without_outliers({}, 1.0).empty());
}

}  // namespace
}  // namespace palpate
