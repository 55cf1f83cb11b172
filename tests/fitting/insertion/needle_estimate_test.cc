#include "fitting/insertion/needle_estimate.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "fitting/insertion/toughness.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

TEST(NeedleEstimate, HalfIntervalHasItsLimits) {
  EXPECT_NEAR(half_interval_95(2.0, 0.0), 3.919928, 1e-6);
  EXPECT_NEAR(half_interval_95(0.0, 2.0), 1.9, 1e-9);
  EXPECT_NEAR(half_interval_95(1e-4, 1.0), 0.95, 1e-3);
}

// 10^6 draws: the share has a standard deviation of 2e-4.
TEST(NeedleEstimate, HalfIntervalHoldsNineteenOfTwenty) {
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

TEST(NeedleEstimate, VarianceOfAProductIsOfFirstOrder) {
  const Eigen::Vector2d q(2.0, 5.0);
  Eigen::Matrix2d covariance;
  covariance << 0.01, 0.002, 0.002, 0.04;
  const NeedleEstimate product = estimate(
      [](const Eigen::VectorXd& at) {
        return at[0] * at[1];
      },
      q, covariance);
  EXPECT_NEAR(product.value, 10.0, 1e-12);
  EXPECT_NEAR(product.sd * product.sd, 25.0 * 0.01 + 4.0 * 0.04 + 20.0 * 0.002, 1e-9);
}

TEST(NeedleEstimate, IsRefusedWithoutACovariance) {
  const Eigen::VectorXd q = Eigen::VectorXd::Ones(1);
  const NeedleEstimate none = estimate(
      [](const Eigen::VectorXd& at) {
        return at[0];
      },
      q, Eigen::MatrixXd::Constant(1, 1, std::nan("")));
  EXPECT_FALSE(none.refused.empty());
}

NeedleEstimate cutting_force(double newtons) {
  return {newtons, 0.01 * newtons, 0.98 * newtons, 1.02 * newtons, {}};
}

// Gokgol 2012: 164 J/m^2 in bovine liver; an edge of 1.5 mm cuts it with 0.25 N.
TEST(Toughness, OfLiverComesBack) {
  const NeedleEstimate found = toughness_of(cutting_force(164.0 * 1.5e-3), 1.5e-3);
  EXPECT_NEAR(found.value, 164.0, 1e-9);
  EXPECT_NEAR(found.low, 0.98 * 164.0, 1e-9);
  EXPECT_NEAR(164.0 * 1.5e-3, 0.25, 0.005);
  EXPECT_EQ(toughness_warning(found), "");
}

TEST(Toughness, OfATearTestIsWarnedOf) {
  const NeedleEstimate found = toughness_of(cutting_force(17100.0 * 0.7e-3), 0.7e-3);
  EXPECT_NE(toughness_warning(found).find("15 to 27 times"), std::string::npos);
  EXPECT_EQ(toughness_warning(toughness_of(cutting_force(1136.0 * 0.7e-3), 0.7e-3)),
            "");
}

TEST(Toughness, NeedsAnEdgeAndACuttingForce) {
  EXPECT_THROW(static_cast<void>(toughness_of(cutting_force(1.0), 0.0)), InputError);
  const double nothing = std::nan("");
  EXPECT_THROW(static_cast<void>(toughness_of(cutting_force(1.0), nothing)),
               InputError);
  EXPECT_EQ(toughness_of(refused_estimate("why"), 1e-3).refused, "why");
}

}  // namespace
}  // namespace palpate
