// Stated errors of fitted forces against their scatter over repeated measurements.
#include "fitting/curve/law_error.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/synthetic_curve.h"

namespace palpate {
namespace {

TEST(LogForceErrors, CoverTheTruthNineteenTimesOfTwenty) {
  constexpr int kRuns = 200;
  // Depths from a quarter on: the law's truth is (d / 5 mm)^1.5 N.
  const Eigen::Vector3d depth_m(0.00125, 0.0025, 0.0045);
  Eigen::Array3d covered = Eigen::Array3d::Zero();
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const Approach approach = select_approach(synthetic({.samples = 150}, seed));
    const ContactFit fit = fit_contact(approach);
    const Eigen::VectorXd error = log_force_errors(approach, fit, depth_m);
    for (Eigen::Index k = 0; k < 3; ++k) {
      const double truth = 1.5 * std::log(depth_m[k] / kSyntheticDepth);
      const double off = std::log(contact_force_n(fit, depth_m[k])) - truth;
      covered[k] += std::abs(off) <= 1.96 * error[k] ? 1.0 : 0.0;
    }
  }
  // 4 binomial standard deviations of 200 runs: 0.06.
  EXPECT_GT(covered.minCoeff() / kRuns, 0.89);
  EXPECT_LT(covered.maxCoeff() / kRuns, 0.995);
}

TEST(LogForceErrors, GoWithTheNoise) {
  const Eigen::Vector2d depth_m(0.001, 0.004);
  const auto errors = [&](double noise_n) {
    const Approach approach = select_approach(synthetic({.noise_n = noise_n}, 3));
    return log_force_errors(approach, fit_contact(approach), depth_m);
  };
  const Eigen::VectorXd quiet = errors(0.002);
  const Eigen::VectorXd loud = errors(0.008);
  for (Eigen::Index k = 0; k < 2; ++k) {
    EXPECT_NEAR(loud[k] / quiet[k], 4.0, 0.8);
  }
  EXPECT_GT(quiet[0], quiet[1]);
}

}  // namespace
}  // namespace palpate
