#include "fitting/curve/misfit.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace {

struct Residuals {
  std::vector<double> x, value;
};

// Noise of standard deviation 1 whose neighbours correlate by rho, and a wave.
Residuals made(int samples, double rho, double wave, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  Residuals made;
  double noise = normal(generator);
  for (int i = 0; i < samples; ++i) {
    const double x = static_cast<double>(i) / (samples - 1);
    made.x.push_back(x);
    made.value.push_back(noise + std::sqrt(2.0) * wave * std::sin(9.0 * x));
    noise = rho * noise + std::sqrt(1.0 - rho * rho) * normal(generator);
  }
  return made;
}

TEST(Misfit, TellsNoiseFromAWave) {
  for (const int samples : {100, 350, 3000}) {
    for (const double rho : {0.0, 0.5, 0.8}) {
      double noise = 0.0, missed = 0.0;
      int taken_for_shape = 0, found = 0;
      constexpr int kRuns = 40;
      for (unsigned seed = 1; seed <= kRuns; ++seed) {
        const Residuals none = made(samples, rho, 0.0, seed);
        taken_for_shape += matters(find_misfit(none.x, none.value), 1.0) ? 1 : 0;
        const Residuals wave = made(samples, rho, 3.0, seed);
        const Misfit misfit = find_misfit(wave.x, wave.value);
        found += matters(misfit, 1.0) ? 1 : 0;
        noise += misfit.noise_sd / kRuns;
        missed += misfit.missed_rms / kRuns;
      }
      EXPECT_EQ(taken_for_shape, 0) << samples << " " << rho;
      EXPECT_EQ(found, kRuns) << samples << " " << rho;
      EXPECT_NEAR(noise, 1.0, 0.35) << samples << " " << rho;
      EXPECT_NEAR(missed, 3.0, 0.3) << samples << " " << rho;
    }
  }
}

TEST(Misfit, OneStepIsMissedAndIsNoNoise) {
  Residuals step = made(500, 0.0, 0.0, 3);
  for (int i = 250; i < 260; ++i) {
    step.value[static_cast<std::size_t>(i)] += 20.0;
  }
  const Misfit misfit = find_misfit(step.x, step.value);
  EXPECT_NEAR(misfit.noise_sd, 1.0, 0.5);
  EXPECT_NEAR(misfit.missed_rms, 20.0 * std::sqrt(0.02), 0.5);
  EXPECT_TRUE(matters(misfit, 20.0));
}

TEST(Misfit, SurvivesAFewSamplesNoSpreadAndOnePlace) {
  for (const std::vector<double>& value :
       {std::vector<double>{1.0, -1.0, 0.5}, std::vector<double>(9, 0.0),
        std::vector<double>(30, 1.0)}) {
    for (const double spread : {0.0, 1.0}) {
      std::vector<double> x(value.size());
      for (std::size_t i = 0; i < x.size(); ++i) {
        x[i] = spread * static_cast<double>(i);
      }
      const Misfit misfit = find_misfit(x, value);
      EXPECT_TRUE(std::isfinite(misfit.noise_sd));
      EXPECT_TRUE(std::isfinite(misfit.missed_rms));
      EXPECT_FALSE(std::isnan(misfit.deviations));
    }
  }
}

}  // namespace
}  // namespace palpate
