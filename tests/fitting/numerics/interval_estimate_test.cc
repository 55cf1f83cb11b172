#include "fitting/numerics/interval_estimate.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(IntervalEstimate, HalfIntervalHasItsLimits) {
  EXPECT_NEAR(half_interval_95(2.0, 0.0), 3.919928, 1e-6);
  EXPECT_NEAR(half_interval_95(0.0, 2.0), 1.9, 1e-9);
  EXPECT_NEAR(half_interval_95(1e-4, 1.0), 0.95, 1e-3);
}

// 10^6 draws: the share has a standard deviation of 2e-4.
TEST(IntervalEstimate, HalfIntervalHoldsNineteenOfTwenty) {
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> even(-1.0, 1.0);
  const double reach = half_interval_95(0.6, 1.0);
  int held = 0;
  for (int i = 0; i < 1000000; ++i) {
    held += std::abs(0.6 * normal(generator) + even(generator)) <= reach ? 1 : 0;
  }
  EXPECT_NEAR(held / 1e6, 0.95, 1e-3);
}

TEST(IntervalEstimate, VarianceOfAProductIsOfFirstOrder) {
  const Eigen::Vector2d q(2.0, 5.0);
  Eigen::Matrix2d covariance;
  covariance << 0.01, 0.002, 0.002, 0.04;
  const IntervalEstimate product = estimate(
      [](const Eigen::VectorXd& at) {
        return at[0] * at[1];
      },
      q, covariance);
  EXPECT_NEAR(product.value, 10.0, 1e-12);
  EXPECT_NEAR(product.sd * product.sd, 25.0 * 0.01 + 4.0 * 0.04 + 20.0 * 0.002, 1e-9);
}

TEST(IntervalEstimate, IsRefusedWithoutACovariance) {
  const Eigen::VectorXd q = Eigen::VectorXd::Ones(1);
  const IntervalEstimate none = estimate(
      [](const Eigen::VectorXd& at) {
        return at[0];
      },
      q, Eigen::MatrixXd::Constant(1, 1, std::nan("")));
  EXPECT_FALSE(none.refused.empty());
}

}  // namespace
}  // namespace palpate
