#include "fitting/insertion/force_falls.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace {

std::vector<double> noise(std::size_t n, double sd, double rho, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values(n);
  double now = normal(generator);
  for (double& value : values) {
    value = sd * now;
    now = rho * now + std::sqrt(1.0 - rho * rho) * normal(generator);
  }
  return values;
}

TEST(ForceFalls, NormalQuantilesAreThoseOfTables) {
  EXPECT_NEAR(normal_quantile_above(0.025), 1.959964, 1e-6);
  EXPECT_NEAR(normal_quantile_above(1e-6), 4.753424, 1e-6);
}

// One in a thousand is stated: 2000 files have more than 7 with probability 0.001.
TEST(ForceFalls, NoiseAloneGivesFewerThanStated) {
  for (const double rho : {0.0, 0.5, 0.9}) {
    int files = 0;
    for (unsigned seed = 1; seed <= 2000; ++seed) {
      files += find_force_falls(noise(600, 0.01, rho, seed)).empty() ? 0 : 1;
    }
    EXPECT_LE(files, 7) << rho;
  }
}

TEST(ForceFalls, ARisingForceHasNone) {
  std::vector<double> force = noise(1000, 1e-4, 0.0, 3);
  for (std::size_t i = 0; i < force.size(); ++i) {
    const double x = std::max(0.0, static_cast<double>(i) - 300.0) / 700.0;
    force[i] += 3.0 * x * x + (i > 600 ? 0.01 * static_cast<double>(i - 600) : 0.0);
  }
  EXPECT_TRUE(find_force_falls(force).empty());
}

TEST(ForceFalls, AFallIsFoundBetweenItsSamples) {
  std::vector<double> force = noise(1000, 0.01, 0.0, 5);
  for (std::size_t i = 0; i < force.size(); ++i) {
    force[i] += i < 400 ? 1.5e-3 * static_cast<double>(i) : 0.2;
  }
  const auto falls = find_force_falls(force);
  ASSERT_EQ(falls.size(), 1U);
  EXPECT_EQ(falls[0].before, 399U);
  EXPECT_EQ(falls[0].after, 400U);
  EXPECT_GT(falls[0].deviations, 10.0);
}

TEST(ForceFalls, AFallOverSeveralSamplesIsOne) {
  std::vector<double> force = noise(1000, 0.01, 0.0, 6);
  for (std::size_t i = 0; i < force.size(); ++i) {
    const double share = std::clamp((static_cast<double>(i) - 400.0) / 4.0, 0.0, 1.0);
    force[i] += 1.0 - 0.8 * share;
  }
  const auto falls = find_force_falls(force);
  ASSERT_EQ(falls.size(), 1U);
  EXPECT_EQ(falls[0].before, 400U);
  EXPECT_EQ(falls[0].after, 404U);
}

TEST(ForceFalls, FewSamplesHaveNone) {
  EXPECT_TRUE(find_force_falls(std::vector<double>(39, 0.0)).empty());
  EXPECT_TRUE(find_force_falls({}).empty());
}

}  // namespace
}  // namespace palpate
