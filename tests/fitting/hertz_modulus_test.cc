#include "fitting/hertz_modulus.h"

#include <cmath>

#include <gtest/gtest.h>

#include "formats/error.h"
#include "tests/fitting/synthetic_curve.h"

namespace palpate {
namespace {

constexpr double kRadius = 0.03;  // [m]

HertzModulus modulus(const SyntheticCurve& curve, unsigned seed, double nu = 0.5) {
  const Approach approach = select_approach(synthetic(curve, seed));
  return hertz_modulus(approach, fit_contact(approach), kRadius, nu);
}

// F = 1 N at 5 mm = 4/3 E/(1 - nu^2) sqrt(R) (5 mm)^1.5
double exact_pa(double nu) {
  return 0.75 * (1.0 - nu * nu) / std::sqrt(kRadius) / std::pow(5e-3, 1.5);
}

TEST(HertzModulus, InvertsHertz) {
  for (const double nu : {0.0, 0.3, 0.5}) {
    const HertzModulus result = modulus({.noise_n = 0.0}, 1, nu);
    EXPECT_EQ(result.refused, "");
    EXPECT_NEAR(result.youngs_modulus_pa, exact_pa(nu), 1e-6 * exact_pa(nu));
    EXPECT_TRUE(result.fit.flags.empty());
  }
}

// Of 24 runs about 1 lies beyond 2 standard deviations, 4 hardly ever.
TEST(HertzModulus, StatesHowFarItMayBeOff) {
  int beyond_two = 0;
  for (unsigned seed = 1; seed <= 24; ++seed) {
    const HertzModulus result = modulus({}, seed);
    EXPECT_GT(result.sd_pa, 0.0);
    EXPECT_LT(result.sd_pa, 0.02 * exact_pa(0.5));
    beyond_two +=
        std::abs(result.youngs_modulus_pa - exact_pa(0.5)) > 2.0 * result.sd_pa ? 1 : 0;
  }
  EXPECT_LE(beyond_two, 4);
}

TEST(HertzModulus, SaysWhereTheCurveIsNotHertz) {
  EXPECT_TRUE(modulus({.exponent = 2.2}, 1).fit.has(FitFlag::kHertzExponentRefuted));
  const Approach approach = select_approach(synthetic({}, 1));
  EXPECT_TRUE(hertz_modulus(approach, fit_contact(approach), 0.01, 0.5)
                  .fit.has(FitFlag::kHertzDepthExceeded));
}

TEST(HertzModulus, IsRefusedWithoutAContactPoint) {
  const HertzModulus result = modulus({.exponent = 1.2, .free_m = 0.0}, 1);
  EXPECT_NE(result.refused.find("already in contact"), std::string::npos);
  EXPECT_TRUE(std::isnan(result.youngs_modulus_pa));
}

TEST(HertzModulus, RefusesImpossibleNumbers) {
  const Approach approach = select_approach(synthetic({}, 1));
  const ContactFit fit = fit_contact(approach);
  for (const double radius : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THROW((void)hertz_modulus(approach, fit, radius, 0.5), InputError);
  }
  for (const double nu : {0.51, -1.0, std::nan("")}) {
    EXPECT_THROW((void)hertz_modulus(approach, fit, 0.01, nu), InputError);
  }
}

}  // namespace
}  // namespace palpate
