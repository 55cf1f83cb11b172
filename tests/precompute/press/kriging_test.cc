// Kriging against what defines it: unbiased, exact where it knows, least variance.
#include "precompute/press/kriging.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kNugget = 4e-4;  // as the header's covariance has it: a share of 2 %

double covariance(double distance) {
  const double r = std::numbers::sqrt3 * distance;
  return (1.0 + r) * std::exp(-r);
}

Eigen::MatrixXd places(Eigen::Index n) {
  Eigen::MatrixXd x(n, 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    x(i, 0) = std::fmod(0.618034 * static_cast<double>(i), 1.0);
    x(i, 1) = static_cast<double>(i) / static_cast<double>(n);
  }
  return x;
}

Eigen::MatrixXd without_row(const Eigen::MatrixXd& of, Eigen::Index row) {
  Eigen::MatrixXd rest(of.rows() - 1, of.cols());
  rest << of.topRows(row), of.bottomRows(of.rows() - 1 - row);
  return rest;
}

// The textbook's system: covariances bordered by the condition that weights sum up to
// 1, solved whole.
TEST(Kriging, SolvesTheBorderedSystem) {
  const Eigen::MatrixXd x = places(7);
  const Eigen::Vector2d place(0.4, 0.6);
  Eigen::MatrixXd system = Eigen::MatrixXd::Ones(8, 8);
  Eigen::VectorXd right = Eigen::VectorXd::Ones(8);
  system(7, 7) = 0.0;
  for (Eigen::Index i = 0; i < 7; ++i) {
    for (Eigen::Index j = 0; j < 7; ++j) {
      system(i, j) =
          covariance((x.row(i) - x.row(j)).norm()) + (i == j ? kNugget : 0.0);
    }
    right[i] = covariance((x.row(i).transpose() - place).norm());
  }
  const Eigen::VectorXd expected = system.fullPivLu().solve(right);
  const Kriging::Prediction found = Kriging(x).at(place);
  EXPECT_LT((found.weight - expected.head(7)).norm(), 1e-10);
  EXPECT_NEAR(found.variance, 1.0 + kNugget - expected.dot(right), 1e-10);
}

TEST(Kriging, LeavesOutAsIfNeverKnown) {
  const Eigen::MatrixXd x = places(9);
  Eigen::MatrixXd value(9, 2);
  for (Eigen::Index i = 0; i < 9; ++i) {
    value.row(i) << std::sin(3.0 * x(i, 0)), x(i, 1) * x(i, 1);
  }
  const Kriging all(x);
  const Eigen::MatrixXd off = all.left_out(value);
  for (Eigen::Index i = 0; i < 9; ++i) {
    const Kriging::Prediction others =
        Kriging(without_row(x, i)).at(x.row(i).transpose());
    const Eigen::RowVectorXd predicted =
        others.weight.transpose() * without_row(value, i);
    EXPECT_LT((off.row(i) - (value.row(i) - predicted)).norm(), 1e-10);
    EXPECT_NEAR(all.left_out_variance()[i], others.variance, 1e-10);
  }
}

TEST(Kriging, KnowsNothingFarAwayButTheMean) {
  const Eigen::MatrixXd x = places(5);
  const Kriging::Prediction far = Kriging(x).at(Eigen::Vector2d(100.0, 0.0));
  EXPECT_NEAR(far.weight.sum(), 1.0, 1e-12);
  EXPECT_GT(far.variance, 1.0);
  EXPECT_LT(Kriging(x).at(x.row(2).transpose()).variance, 3.0 * kNugget);
}

TEST(Kriging, TakesTheMeanOfPlacesThatCoincide) {
  const Kriging kriging(Eigen::MatrixXd::Zero(3, 2));
  EXPECT_LT((kriging.at(Eigen::Vector2d(0.1, 0.0)).weight -
             Eigen::Vector3d::Constant(1.0 / 3.0))
                .norm(),
            1e-9);
}

TEST(Kriging, RefusesPlacesThatAreNotFinite) {
  Eigen::MatrixXd x = places(3);
  x(1, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)Kriging(x), NumericalError);
  const Kriging kriging(places(3));
  EXPECT_TRUE(std::isnan(kriging.at(x.row(1).transpose()).variance));  // and not exact
}

}  // namespace
}  // namespace palpate
