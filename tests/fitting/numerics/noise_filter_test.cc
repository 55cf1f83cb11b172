#include "fitting/numerics/noise_filter.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/fitting/numerics/dense_covariance.h"

namespace palpate {
namespace {

TEST(NoiseFilter, ProductsAreThoseOfItsCovariance) {
  const Eigen::MatrixXd X = Eigen::MatrixXd::Random(30, 3);
  for (const bool smooth : {false, true}) {
    const CorrelatedNoise noise{0.3, 1.2, 0.8, smooth};
    EXPECT_LT((times_covariance(noise, X) - dense_covariance(noise, 30) * X).norm(),
              1e-13 * X.norm());
  }
}

TEST(NoiseFilter, WeighedSquaresAreThoseOfItsCovariance) {
  const Eigen::VectorXd r = Eigen::VectorXd::Random(60);
  for (const bool smooth : {false, true}) {
    const CorrelatedNoise noise{0.3, 1.2, 0.8, smooth};
    const double squares = r.dot(dense_covariance(noise, 60).ldlt().solve(r));
    EXPECT_NEAR(weighed_squares(noise, r), squares, 1e-10 * squares) << smooth;
  }
}

TEST(NoiseFilter, LongRunVarianceIsThatOfAMean) {
  constexpr Eigen::Index kMany = 2000;
  for (const bool smooth : {false, true}) {
    const CorrelatedNoise noise{0.3, 1.2, 0.8, smooth};
    EXPECT_NEAR(dense_covariance(noise, kMany).sum() / kMany, noise.long_run_variance(),
                0.01 * noise.long_run_variance())
        << smooth;
  }
}

// White to the fit, and of the right size: r = L e has the squares of e.
TEST(NoiseFilter, WhitenedSamplesOfTheNoiseAreWhite) {
  const Eigen::VectorXd e = Eigen::VectorXd::Random(60);
  for (const bool smooth : {false, true}) {
    const CorrelatedNoise noise{0.3, 1.2, 0.8, smooth};
    const Eigen::LLT<Eigen::MatrixXd> factor(dense_covariance(noise, 60));
    Eigen::MatrixXd white = (factor.matrixL() * e).transpose();
    const double log_det = whiten(noise, white);
    EXPECT_LT((white.transpose() - e).norm(), 1e-9 * e.norm()) << smooth;
    EXPECT_NEAR(log_det, 2.0 * factor.matrixLLT().diagonal().array().log().sum(), 1e-9)
        << smooth;
  }
}

}  // namespace
}  // namespace palpate
