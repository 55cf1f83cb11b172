// Hertz's half-space: what one frictionless curve can tell of a material.
#include "fitting/material/material_fit.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "fitting/material/sweep_interpolation.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kRadius = 0.01;

double hertz_n(double youngs_modulus_pa, double poissons_ratio, double depth_m) {
  return 4.0 / 3.0 * youngs_modulus_pa / (1.0 - poissons_ratio * poissons_ratio) *
         std::sqrt(kRadius) * std::pow(depth_m, 1.5);
}

std::vector<double> logarithmic(double from, double to, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    values.push_back(from * std::pow(to / from, i / (count - 1.0)));
  }
  return values;
}

ResponseSweep hertz_sweep(bool with_ratio) {
  ResponseSweep sweep;
  sweep.parameter.push_back({"body.youngs_modulus_pa", logarithmic(2e3, 2e4, 6)});
  if (with_ratio) {
    sweep.parameter.push_back({"body.poissons_ratio", logarithmic(0.2, 0.49, 6)});
  }
  sweep.vertex = {4};
  for (int k = 1; k <= 10; ++k) {
    sweep.depth_m.push_back(4e-3 * k * k / 100.0);
  }
  for (std::size_t c = 0; c < sweep.combinations(); ++c) {
    const std::vector<double> value = sweep.values_at(c);
    for (const double d : sweep.depth_m) {
      sweep.force_n.push_back(hertz_n(value[0], with_ratio ? value[1] : 0.45, d));
    }
  }
  return sweep;
}

// Contact at 1 mm, 0.02 N offset.
MaterialCurve measured(double youngs_modulus_pa, double poissons_ratio,
                       double noise_n = 2e-3, unsigned seed = 1) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> noise(0.0, noise_n);
  Measurement m;
  for (int i = 0; i < 200; ++i) {
    const double x = 4.5e-3 * i / 199.0;
    const double d = x - 1e-3;
    const double f = d > 0.0 ? hertz_n(youngs_modulus_pa, poissons_ratio, d) : 0.0;
    m.depth_m.push_back(x);
    m.force_n.push_back(0.02 + f + noise(generator));
  }
  return {select_approach(m), 0, 1.3e-3};
}

TEST(SweepInterpolation, IsExactForPowersAndCloseForSmoothLaws) {
  const ResponseSweep sweep = hertz_sweep(true);
  const SweepInterpolation law(sweep, 0);
  const double x[] = {std::log(7123.0), std::log(0.2), std::log(1.7e-3)};
  EXPECT_NEAR(law.log_force(x), std::log(hertz_n(7123.0, 0.2, 1.7e-3)), 1e-12);
  const double outside[] = {std::log(1e5), std::log(0.49), std::log(1e-6)};
  EXPECT_NEAR(law.log_force(outside), std::log(hertz_n(1e5, 0.49, 1e-6)), 1e-11);
  // 1 / (1 - nu^2) is no power: third order between the grid's points.
  for (const double ratio : {0.22, 0.31, 0.4, 0.47}) {
    const double between[] = {std::log(5e3), std::log(ratio), std::log(1e-3)};
    EXPECT_NEAR(law.log_force(between), std::log(hertz_n(5e3, ratio, 1e-3)), 1e-3);
  }
}

TEST(MaterialFit, FindsYoungsModulusWithItsInterval) {
  const MaterialCurve curve[] = {measured(6500.0, 0.45)};
  const MaterialFit fit = fit_material(hertz_sweep(false), curve);
  ASSERT_EQ(fit.parameter.size(), 1U);
  const MaterialParameter& modulus = fit.parameter[0];
  EXPECT_TRUE(fit.converged);
  EXPECT_TRUE(modulus.identifiable) << modulus.why_not;
  EXPECT_NEAR(modulus.value, 6500.0, 3.0 * 6500.0 * modulus.sd_log);
  EXPECT_LT(modulus.sd_log, 0.02);
  EXPECT_LT(modulus.low, modulus.value);
  EXPECT_GT(modulus.high, modulus.value);
  // A nearly quadratic likelihood: the profile's interval is that of the sd.
  EXPECT_NEAR(std::log(modulus.high / modulus.low), 2.0 * 1.96 * modulus.sd_log,
              0.2 * 2.0 * 1.96 * modulus.sd_log);
  EXPECT_NEAR(fit.contact_point_m[0], 1e-3, 5e-5);
  EXPECT_NEAR(fit.rms_n[0], 2e-3, 4e-4);
}

TEST(MaterialFit, IntervalsCoverTheTruthNineteenTimesOfTwenty) {
  constexpr int kRuns = 60;
  const ResponseSweep sweep = hertz_sweep(false);
  int covered = 0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const MaterialCurve curve[] = {measured(6500.0, 0.45, 4e-3, seed)};
    const MaterialParameter modulus = fit_material(sweep, curve).parameter[0];
    covered += modulus.low <= 6500.0 && 6500.0 <= modulus.high ? 1 : 0;
  }
  EXPECT_GE(covered, 51);  // 57 of 60 expected, sd 1.7
}

// A sweep whose forces are wrong by a common factor: the interval covers the truth as
// often as it says where it is told how wrong they may be, and never where it is not.
TEST(MaterialFit, TheSweepsOwnErrorIsPartOfTheInterval) {
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  constexpr int kRuns = 60;
  int told = 0, untold = 0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    ResponseSweep sweep = hertz_sweep(false);
    const double factor = std::exp(0.05 * normal(generator));
    for (double& force : sweep.force_n) {
      force *= factor;
    }
    const MaterialCurve curve[] = {measured(6500.0, 0.45, 1e-3, seed)};
    for (const double error : {0.0, std::expm1(0.05)}) {
      sweep.error_relative = error;
      const MaterialParameter modulus = fit_material(sweep, curve).parameter[0];
      EXPECT_TRUE(modulus.identifiable);
      (error > 0.0 ? told : untold) +=
          modulus.low <= 6500.0 && 6500.0 <= modulus.high ? 1 : 0;
    }
  }
  EXPECT_GE(told, 51);  // 57 of 60 expected, sd 1.7
  EXPECT_LE(untold, 20);
}

TEST(MaterialFit, CannotTellModulusFromRatioByOneFrictionlessCurve) {
  const MaterialCurve curve[] = {measured(6500.0, 0.35)};
  const MaterialFit fit = fit_material(hertz_sweep(true), curve);
  for (const MaterialParameter& parameter : fit.parameter) {
    EXPECT_FALSE(parameter.identifiable) << parameter.name;
    EXPECT_NE(parameter.why_not, "");
  }
  EXPECT_LT(fit.correlation(0, 1), -0.99);
  // What it can tell is E / (1 - nu^2).
  const double plane =
      fit.parameter[0].value / (1.0 - fit.parameter[1].value * fit.parameter[1].value);
  EXPECT_NEAR(plane, 6500.0 / (1.0 - 0.35 * 0.35), 0.02 * plane);
}

TEST(MaterialFit, SaysWhenTheSweepDoesNotReachTheMaterial) {
  const MaterialCurve curve[] = {measured(5e4, 0.45)};
  const MaterialFit fit = fit_material(hertz_sweep(false), curve);
  EXPECT_FALSE(fit.parameter[0].identifiable);
  EXPECT_NEAR(fit.parameter[0].value, 2e4, 1.0);
}

TEST(MaterialFit, RefusesCurvesFarDeeperThanTheSweep) {
  MaterialCurve deep = measured(6500.0, 0.45);
  for (double& x : deep.approach.displacement_m) {
    x *= 10.0;
  }
  const MaterialCurve curves[] = {deep};
  EXPECT_THROW((void)fit_material(hertz_sweep(false), curves), InputError);
  EXPECT_THROW((void)fit_material(hertz_sweep(false), {}), InputError);
}

}  // namespace
}  // namespace palpate
