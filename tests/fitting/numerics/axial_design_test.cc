#include "fitting/numerics/axial_design.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace palpate {
namespace {

struct Moments {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

Moments moments(const AxialDesign& design) {
  const Eigen::Index m = design.points.front().x.size();
  Moments result{Eigen::VectorXd::Zero(m), Eigen::MatrixXd::Zero(m, m)};
  for (const WeighedPoint& p : design.points) {
    result.mean += p.weight * p.x;
  }
  for (const WeighedPoint& p : design.points) {
    const Eigen::VectorXd off = p.x - result.mean;
    result.covariance += p.weight * off * off.transpose();
  }
  return result;
}

TEST(AxialDesign, HasMeanCovarianceAndIntegralOfANormalDensity) {
  Eigen::Matrix3d C;
  C << 0.09, 0.03, 0.0, 0.03, 0.04, -0.01, 0.0, -0.01, 0.16;
  const Eigen::Matrix3d H = C.inverse();
  const Eigen::Vector3d mean(1.0, -2.0, 0.5);
  const AxialDesign design = axial_design(
      [&](const Eigen::VectorXd& x) {
        return 0.7 + 0.5 * (x - mean).dot(H * (x - mean));
      },
      mean, 0.2, 2.0);
  const Moments found = moments(design);
  EXPECT_LT((found.mean - mean).norm(), 1e-9);
  EXPECT_LT((found.covariance - C).norm(), 1e-9);
  EXPECT_NEAR(
      design.log_evidence,
      -0.7 + 0.5 * std::log(std::pow(2.0 * std::numbers::pi, 3.0) * C.determinant()),
      1e-9);
}

TEST(AxialDesign, LeansToTheHeavierSide) {
  // A gamma density's logarithm: its left tail is long.
  const AxialDesign design = axial_design(
      [](const Eigen::VectorXd& x) {
        return std::exp(x[0]) - x[0];
      },
      Eigen::VectorXd::Zero(1), 0.2, 2.0);
  EXPECT_LT(moments(design).mean[0], -0.2);
}

TEST(AxialDesign, LeavesOutWhereThereIsNoDensityAndIsNotEndless) {
  const AxialDesign design = axial_design(
      [](const Eigen::VectorXd& x) {
        return x[0] > 0.5 ? std::numeric_limits<double>::infinity() : 0.0;
      },
      Eigen::VectorXd::Zero(1), 0.2, 1.5);
  EXPECT_EQ(design.points[2].weight, 0.0);
  EXPECT_NEAR(design.points[1].x[0], -1.1 * 1.5, 1e-12);
}

}  // namespace
}  // namespace palpate
