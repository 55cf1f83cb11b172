#include "fitting/numerics/correlated_noise.h"

#include <cmath>
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/fitting/numerics/dense_covariance.h"

namespace palpate {
namespace {

constexpr Eigen::Index kSamples = 200;

// A line through samples in a row.
Eigen::MatrixXd line_jacobian(Eigen::Index n) {
  Eigen::MatrixXd J(n, 2);
  J.col(0).setOnes();
  J.col(1).setLinSpaced(n, -1.0, 1.0);
  return J;
}

Eigen::VectorXd drawn(const CorrelatedNoise& noise, Eigen::Index n,
                      std::mt19937& generator) {
  std::normal_distribution<double> normal;
  Eigen::VectorXd r(n);
  double shared = normal(generator);
  for (Eigen::Index i = 0; i < n; ++i) {
    r[i] = noise.shared * shared + noise.white * normal(generator);
    shared =
        noise.rho * shared + std::sqrt(1.0 - noise.rho * noise.rho) * normal(generator);
  }
  return r;
}

Eigen::VectorXd residual_of_fit(const Eigen::MatrixXd& J, const Eigen::VectorXd& y) {
  return y - J * (J.transpose() * J).ldlt().solve(J.transpose() * y);
}

// How often a parameter, zero in truth, lies within 1.96 of its stated deviations.
TEST(CorrelatedNoise, IntervalsHoldTheTruthAsOftenAsTheySay) {
  std::mt19937 generator(7);
  const Eigen::MatrixXd J = line_jacobian(kSamples);
  constexpr int kDraws = 400;
  for (const double rho : {0.0, 0.5, 0.9}) {
    const CorrelatedNoise truth{rho > 0.0 ? 0.2 : 1.0, rho > 0.0 ? 1.0 : 0.0, rho};
    Eigen::Array2d held = Eigen::Array2d::Zero();
    for (int k = 0; k < kDraws; ++k) {
      const Eigen::VectorXd y = drawn(truth, kSamples, generator);
      const Eigen::VectorXd r = residual_of_fit(J, y);
      const Eigen::Vector2d q = (J.transpose() * J).ldlt().solve(J.transpose() * y);
      const Eigen::Array2d sd =
          covariance_under_noise(J, r, kSamples).diagonal().array().sqrt();
      held += (q.array().abs() <= 1.96 * sd).cast<double>() / kDraws;
    }
    // Three standard errors of 400 draws are 0.033.
    EXPECT_GT(held.minCoeff(), 0.92) << rho;
    EXPECT_LT(held.maxCoeff(), 0.99) << rho;
  }
}

// A bow that the line does not follow is shared by all samples.
TEST(CorrelatedNoise, WhatALawMissesWidensIntervalsToItsOwnSizeAtMost) {
  const Eigen::MatrixXd J = line_jacobian(kSamples);
  const Eigen::VectorXd bow = J.col(1).array().square();
  const Eigen::VectorXd r = residual_of_fit(J, bow);
  const Eigen::Vector2d sd =
      covariance_under_noise(J, r, kSamples).diagonal().cwiseSqrt();
  const double largest = r.cwiseAbs().maxCoeff();
  const double white =
      std::sqrt(r.squaredNorm() / (kSamples - 2) * (J.transpose() * J).inverse()(0, 0));
  EXPECT_GT(sd.minCoeff(), 2.0 * white);
  EXPECT_LT(sd.maxCoeff(), 5.0 * largest);
}

// Bows of random size and place, that a line misses: their own smooth noise tells how
// far the line's end is off.
TEST(CorrelatedNoise, SmoothShapesThatALawMissesAreCounted) {
  std::mt19937 generator(11);
  const Eigen::MatrixXd J = line_jacobian(kSamples);
  const Eigen::Vector2d end(1.0, 1.0);
  const Eigen::MatrixXd L =
      Eigen::MatrixXd(dense_covariance({0.1, 1.0, std::exp(-1.0 / 8.0), true}, kSamples)
                          .llt()
                          .matrixL());
  std::normal_distribution<double> normal;
  constexpr int kDraws = 300;
  double held = 0.0;
  for (int k = 0; k < kDraws; ++k) {
    const Eigen::VectorXd y = L * Eigen::VectorXd::NullaryExpr(kSamples, [&] {
                                return normal(generator);
                              });
    const Eigen::VectorXd r = residual_of_fit(J, y);
    const double off = end.dot((J.transpose() * J).ldlt().solve(J.transpose() * y));
    const Eigen::MatrixXd C =
        covariance_under_noise(J, r, kSamples, SharedNoise::kAlsoSmooth);
    held += std::abs(off) <= 1.96 * std::sqrt(end.dot(C * end)) ? 1.0 / kDraws : 0.0;
  }
  EXPECT_GT(held, 0.90);
  EXPECT_LT(held, 0.99);
}

// Mean stated over true variance of a line's height, of noise e_i - 0.6 e_(i-1), whose
// covariance is 1.36 on the diagonal and -0.6 beside it.
double stated_of_differing(Eigen::Index n, int draws) {
  std::mt19937 generator(4);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd J = line_jacobian(n);
  const auto rows = static_cast<double>(n);
  const double truth = (1.36 * rows - 1.2 * (rows - 1.0)) / (rows * rows);
  double mean = 0.0;
  for (int k = 0; k < draws; ++k) {
    Eigen::VectorXd y(n);
    double before = normal(generator);
    for (double& value : y) {
      const double white = normal(generator);
      value = white - 0.6 * before;
      before = white;
    }
    const Eigen::VectorXd r = residual_of_fit(J, y);
    mean += covariance_under_noise(J, r, n, SharedNoise::kAlsoRegression)(0, 0) / draws;
  }
  return mean / truth;
}

// An autoregression of the order p that BIC takes follows it up to (1 - 0.6^(p + 1))^2:
// 1.3 of p = 3. White noise would state 8.5 and, of means of five neighbours, 2.5.
TEST(CorrelatedNoise, NeighboursThatDifferMakeAMeanBetter) {
  EXPECT_LT(stated_of_differing(1000, 20), 1.6);
  EXPECT_GT(stated_of_differing(1000, 20), 0.9);
}

// Of so few BIC takes but one, (1 - 0.44^2) / 1.44^2 * 1.36 / 0.16 = 3.3, and white
// noise would state 8.5.
TEST(CorrelatedNoise, FewNeighboursThatDifferAreSeenToo) {
  EXPECT_LT(stated_of_differing(40, 100), 5.0);
}

TEST(CorrelatedNoise, AFewSamplesAreTakenForWhite) {
  std::mt19937 generator(2);
  const Eigen::MatrixXd J = line_jacobian(12);
  const Eigen::VectorXd r = residual_of_fit(J, drawn({0.2, 1.0, 0.9}, 12, generator));
  const Eigen::MatrixXd white =
      (J.transpose() * J).inverse() * r.squaredNorm() / (12 - 2);
  EXPECT_LT((covariance_under_noise(J, r, 12) - white).norm(), 1e-12 * white.norm());
}

TEST(CorrelatedNoise, VeryManySamplesAreAveragedFirst) {
  std::mt19937 generator(3);
  constexpr Eigen::Index kMany = 20000;
  const CorrelatedNoise truth{1.0, 0.5, 0.99};
  const Eigen::MatrixXd J = line_jacobian(kMany);
  const Eigen::MatrixXd bread = (J.transpose() * J).inverse();
  const Eigen::MatrixXd wanted =
      bread * J.transpose() * times_covariance(truth, J) * bread;
  constexpr int kDraws = 20;
  double mean = 0.0;
  for (int k = 0; k < kDraws; ++k) {
    const Eigen::VectorXd r = residual_of_fit(J, drawn(truth, kMany, generator));
    mean += covariance_under_noise(J, r, kMany)(0, 0) / kDraws;
  }
  EXPECT_NEAR(mean / wanted(0, 0), 1.0, 0.2);
}

TEST(CorrelatedNoise, ParametersThatCannotBeToldApartHaveNone) {
  Eigen::MatrixXd J(kSamples, 2);
  J.setOnes();
  std::mt19937 generator(1);
  EXPECT_FALSE(
      covariance_under_noise(J, drawn({1.0, 0.0, 0.0}, kSamples, generator), kSamples)
          .allFinite());
}

TEST(EffectiveSamples, FallWithCorrelation) {
  std::vector<double> white(1000), slow(1000);
  for (std::size_t i = 0; i < white.size(); ++i) {
    white[i] = i % 2 == 0 ? 1.0 : -1.0;
    slow[i] = i / 10 % 2 == 0 ? 1.0 : -1.0;
  }
  EXPECT_EQ(effective_samples(white), 1000.0);
  // Neighbours agree but for one in ten: rho = 0.8, n (1 - 0.8) / (1 + 0.8).
  EXPECT_NEAR(effective_samples(slow), 1000.0 / 9.0, 1.0);
}

}  // namespace
}  // namespace palpate
