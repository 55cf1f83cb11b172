#include "fitting/numerics/autoregression.h"

#include <cmath>
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr double kA1 = 1.6, kA2 = -0.9;  // a line at acos(kA1 / 2 / sqrt(-kA2))

// Yule and Walker's autocorrelations of order 2.
Eigen::VectorXd autocorrelation(Eigen::Index n) {
  Eigen::VectorXd r(n);
  r[0] = 1.0;
  r[1] = kA1 / (1.0 - kA2);
  for (Eigen::Index k = 2; k < n; ++k) {
    r[k] = kA1 * r[k - 1] + kA2 * r[k - 2];
  }
  return r;
}

Autoregression second_order() {
  const double first = autocorrelation(2)[1];
  Autoregression noise;
  noise.coefficients = {Eigen::VectorXd(0), Eigen::VectorXd::Constant(1, first),
                        Eigen::Vector2d(kA1, kA2)};
  noise.surprise = {1.0, 1.0 - first * first,
                    (1.0 - first * first) * (1.0 - kA2 * kA2)};
  return noise;
}

Eigen::MatrixXd second_order_covariance(Eigen::Index n) {
  const Eigen::VectorXd r = autocorrelation(n);
  Eigen::MatrixXd V(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      V(i, j) = r[std::abs(i - j)];
    }
  }
  return V;
}

Eigen::VectorXd second_order_row(Eigen::Index n, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd x(n);
  for (double& value : x) {
    value = normal(generator);
  }
  return Eigen::MatrixXd(second_order_covariance(n).llt().matrixL()) * x;
}

TEST(Autoregression, ProductsAreThoseOfItsCovariance) {
  const Eigen::MatrixXd X = Eigen::MatrixXd::Random(40, 3);
  EXPECT_LT(
      (times_covariance(second_order(), X) - second_order_covariance(40) * X).norm(),
      1e-12 * X.norm());
}

TEST(Autoregression, WhitenedSquaresAndDeterminantAreThoseOfItsCovariance) {
  const Eigen::MatrixXd X = Eigen::MatrixXd::Random(40, 3),
                        V = second_order_covariance(40);
  Eigen::MatrixXd white = X.transpose();
  EXPECT_NEAR(whiten(second_order(), white), std::log(V.determinant()), 1e-9);
  EXPECT_LT((white * white.transpose() - X.transpose() * V.ldlt().solve(X)).norm(),
            1e-11 * (white * white.transpose()).norm());
}

TEST(Autoregression, MeansHaveItsLongRunVariance) {
  const Eigen::Index n = 4000;
  const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(n, 1);
  const double sum = times_covariance(second_order(), ones).sum();
  EXPECT_NEAR(second_order().long_run_variance(), sum / static_cast<double>(n),
              1e-2 * second_order().long_run_variance());
}

TEST(Autoregression, CoefficientsAndOrderAreFound) {
  const Autoregression found = autoregression_of(second_order_row(1000, 3), 20);
  ASSERT_EQ(found.order(), 2);
  // Standard deviation sqrt((1 - a_2^2) / n) = 0.014.
  EXPECT_NEAR(found.coefficients[2][0], kA1, 0.05);
  EXPECT_NEAR(found.coefficients[2][1], kA2, 0.05);
}

// Residuals of a polynomial through first-order noise: their expected correlations are
// known, and what the polynomial took of the noise's slow part comes back.
TEST(Autoregression, WhatAFitTookOfTheNoiseComesBack) {
  const Eigen::Index n = 300;
  Autoregression truth;
  truth.coefficients.emplace_back(Eigen::VectorXd::Constant(1, 0.8));
  truth.surprise.push_back(1.0 - 0.8 * 0.8);
  Eigen::MatrixXd J(n, 5);
  J.col(0).setOnes();
  for (Eigen::Index k = 1; k < 5; ++k) {
    J.col(k) = J.col(k - 1).cwiseProduct(Eigen::VectorXd::LinSpaced(n, -1.0, 1.0));
  }
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd left = I - J * (J.transpose() * J).ldlt().solve(J.transpose());
  const Eigen::MatrixXd C = left * times_covariance(truth, left);
  Autoregression seen;
  const double first = C.diagonal(1).mean() / C.diagonal().mean();
  seen.coefficients.emplace_back(Eigen::VectorXd::Constant(1, first));
  seen.surprise.push_back(1.0 - first * first);
  const double taken = truth.long_run_variance() - seen.long_run_variance();
  const double left_off =
      truth.long_run_variance() - before_fit(seen, J).long_run_variance();
  EXPECT_GT(taken, 0.1 * truth.long_run_variance());
  EXPECT_LT(std::abs(left_off), 0.3 * taken);  // the first order of it is back
}

TEST(Autoregression, WhiteNoiseHasNone) {
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  int without = 0;
  for (int run = 0; run < 100; ++run) {
    Eigen::VectorXd x(300);
    for (double& value : x) {
      value = normal(generator);
    }
    without += autoregression_of(x, 30).order() < 2 ? 1 : 0;
  }
  EXPECT_GE(without, 97);  // BIC takes two more with less than a hundredth
}

TEST(Autoregression, WhatRepeatsItselfExactlyIsFinite) {
  Eigen::VectorXd x(200);
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    x[i] = std::sin(0.3 * static_cast<double>(i));
  }
  const Autoregression found = autoregression_of(x, 20);
  EXPECT_TRUE(std::isfinite(found.long_run_variance()));
  EXPECT_TRUE(times_covariance(found, x).allFinite());
}

}  // namespace
}  // namespace palpate
