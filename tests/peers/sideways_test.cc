// Spectra of sampled sines against their closed forms.
#include "tests/peers/sideways.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace palpate::peers {
namespace {

constexpr int kSamples = 500;
constexpr double kIntervalS = 0.002;  // in all one second: whole hertz are periods
constexpr double kEndHz = 250.0;
constexpr double kRoundingOfSums = 1e-12;

// Of amplitude 5, turned by 0.4, beside a constant of one.
MeanSquares of_sine(double hz) {
  std::vector<Eigen::Vector3d> signal;
  for (int i = 0; i < kSamples; ++i) {
    const double phase = 2.0 * std::numbers::pi * hz * kIntervalS * i + 0.4;
    signal.emplace_back(1.0 + 3.0 * std::sin(phase), 0.0, 4.0 * std::sin(phase));
  }
  return mean_squares(signal, kIntervalS);
}

TEST(MeanSquares, SumToASinesHalfSquareInItsBand) {
  for (const double hz : {4.0, 7.0, 123.0}) {
    const MeanSquares all = of_sine(hz);
    EXPECT_NEAR(all.step_hz, 1.0, kRoundingOfSums);
    EXPECT_NEAR(all.rms(hz - 1.5, hz + 1.5), 5.0 / std::numbers::sqrt2,
                kRoundingOfSums);
    EXPECT_LT(all.rms(hz + 1.5, kEndHz), 1e3 * kRoundingOfSums);
    // The constant is at 0, and by the window at 1 Hz.
    EXPECT_LT(all.rms(1.5, hz - 1.5), 1e3 * kRoundingOfSums);
  }
}

// The transform of the window, d frequencies from its middle, is 1 / (2 pi d (d^2 - 1))
// of the samples for d = 1/2, 3/2, ...: the squares beyond d sum to about
// (4 / 3) (a / (2 pi))^2 / (5 d^5).
TEST(MeanSquares, OfASineBetweenTwoFrequenciesFallOffAsTheWindowDoes) {
  constexpr double kAwayHz = 20.0;
  const double beyond =
      5.0 / (2.0 * std::numbers::pi) * std::sqrt(4.0 / 15.0 / std::pow(kAwayHz, 5));
  const double rms = of_sine(100.5).rms(100.5 + kAwayHz, kEndHz);
  EXPECT_NEAR(rms, beyond, 0.1 * beyond);
}

TEST(Sideways, IsWhatIsAcrossTheNormal) {
  const Eigen::Vector3d normal = Eigen::Vector3d(1.0, 2.0, 2.0) / 3.0;
  const Eigen::Vector3d across(2.0, 1.0, -2.0);
  const std::vector<Eigen::Vector3d> force{5.0 * normal, across - 7.0 * normal};
  const auto found = sideways_n(force, std::vector{normal, normal});
  EXPECT_LT(found[0].norm(), kRoundingOfSums);
  EXPECT_LT((found[1] - across).norm(), kRoundingOfSums);
}

}  // namespace
}  // namespace palpate::peers
