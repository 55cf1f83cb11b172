#include "fitting/curve/power_law_fit.h"

#include <cmath>

#include <gtest/gtest.h>

#include "fitting/curve/power_law_solve.h"
#include "formats/base/error.h"
#include "tests/support/synthetic_curve.h"

namespace palpate {
namespace {

ContactFit fit(const Measurement& measurement, const ContactFitOptions& options = {}) {
  return fit_contact(select_approach(measurement), options);
}

struct Spread {
  double bias_m, sd_m, reported_sd_m;
};

// Error of the contact point over seeded runs.
Spread spread(const SyntheticCurve& curve, const ContactFitOptions& options = {}) {
  constexpr int kRuns = 24;
  double sum = 0.0, squares = 0.0, reported = 0.0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const ContactFit result = fit(synthetic(curve, seed), options);
    EXPECT_TRUE(result.converged);
    const double error = result.contact_point_m - curve.free_m;
    sum += error;
    squares += error * error;
    reported += result.contact_point_sd_m;
  }
  const double mean = sum / kRuns;
  return {mean, std::sqrt((squares - sum * mean) / (kRuns - 1)), reported / kRuns};
}

struct MonteCarloCase {
  const char* name;
  SyntheticCurve curve;
  double bias_max_m;  // 0.02 mm, or 3 standard errors of 24 runs where that is more
};

class ContactFitMonteCarlo : public testing::TestWithParam<MonteCarloCase> {};

// Standard deviations of 24 runs scatter by 15 %: a factor 1.5 is three of that.
TEST_P(ContactFitMonteCarlo, ContactPointIsUnbiasedAndItsDeviationTold) {
  const Spread s = spread(GetParam().curve);
  EXPECT_LE(std::abs(s.bias_m), GetParam().bias_max_m);
  EXPECT_LE(s.sd_m, 1.5 * s.reported_sd_m);
  EXPECT_GE(s.sd_m, s.reported_sd_m / 1.5);
}

INSTANTIATE_TEST_SUITE_P(
    FreeExponent, ContactFitMonteCarlo,
    testing::Values(MonteCarloCase{"Noise05", {}, 0.02e-3},
                    MonteCarloCase{"Noise20", {.noise_n = 0.02}, 0.055e-3},
                    MonteCarloCase{"Drift50", {.drift_n = 0.05}, 0.02e-3},
                    MonteCarloCase{"Exponent25", {.exponent = 2.5}, 0.038e-3},
                    MonteCarloCase{"ShortFreeTravel", {.free_m = 0.3e-3}, 0.042e-3},
                    MonteCarloCase{"ShortFreeTravelDrift50",
                                   {.drift_n = 0.05, .free_m = 0.3e-3},
                                   0.042e-3}),
    [](const auto& case_info) {
      return case_info.param.name;
    });

// Three standard errors of 200 runs are 0.046.
TEST(ContactFit, IntervalsHoldWhereTheNoiseOfNeighboursIsAlike) {
  constexpr int kRuns = 200;
  for (const double rho : {0.5, 0.8, 0.95}) {
    const SyntheticCurve curve{.rho = rho};
    int held = 0;
    for (unsigned seed = 1; seed <= kRuns; ++seed) {
      const ContactFit result = fit(synthetic(curve, seed));
      held += std::abs(result.contact_point_m - curve.free_m) <=
              1.96 * result.contact_point_sd_m;
    }
    EXPECT_GT(held, 0.904 * kRuns - (rho > 0.9 ? 0.02 * kRuns : 0.0)) << rho;
    EXPECT_LT(held, 0.996 * kRuns) << rho;
  }
}

// Twenty samples before contact cannot tell a drift; that it is small tells them.
TEST(ContactFit, ShortFreeTravelIsKnownToAHundredthOfTheDepth) {
  EXPECT_LT(spread({.free_m = 0.3e-3}).sd_m, 0.06e-3);
}

TEST(ContactFit, AWrongFixedExponentMovesTheContactPointByMillimetres) {
  EXPECT_GT(spread({.exponent = 2.5}, {1.5}).bias_m, 1.5e-3);
}

TEST(ContactFit, RecoversEveryParameterWithoutNoise) {
  const SyntheticCurve curve{
      .exponent = 1.7, .noise_n = 0.0, .drift_n = 0.03, .offset_n = -0.2};
  const ContactFit result = fit(synthetic(curve, 1));
  ASSERT_TRUE(result.converged);
  EXPECT_TRUE(result.flags.empty());
  const double expected[] = {-0.2, 0.03 / 7e-3, 2e-3, 1.7, std::pow(5e-3, -1.7)};
  for (std::size_t j = 0; j < 5; ++j) {
    EXPECT_NEAR(result.parameters[j].value, expected[j], 1e-6 * std::abs(expected[j]))
        << result.parameters[j].name;
  }
  EXPECT_NEAR(contact_force_n(result, 5e-3), 1.0, 1e-7);
  EXPECT_EQ(contact_force_n(result, -1e-3), 0.0);
}

// The same curve in other units: contact point and exponent do not know them.
TEST(ContactFit, ScalesWithTheUnitsOfForceAndDepth) {
  const Measurement one = synthetic({}, 3);
  Measurement other = one;
  for (std::size_t i = 0; i < one.depth_m.size(); ++i) {
    other.depth_m[i] *= 1e-4;
    other.force_n[i] *= 1e-7;
  }
  const ContactFit a = fit(one), b = fit(other);
  EXPECT_NEAR(b.contact_point_m, 1e-4 * a.contact_point_m, 1e-9 * 1e-4);
  EXPECT_NEAR(b.contact_point_sd_m, 1e-4 * a.contact_point_sd_m,
              1e-5 * 1e-4 * a.contact_point_sd_m);
  EXPECT_NEAR(b.exponent, a.exponent, 1e-6);
}

TEST(ContactFit, OutliersDoNotMoveTheFit) {
  Measurement m = synthetic({}, 5);
  const ContactFit clean = fit(m);
  for (const std::size_t i : {60U, 61U, 200U, 201U, 348U}) {
    m.force_n[i] += 3.0;  // pairs and the end escape the search for spikes
  }
  const ContactFit wild = fit(m);
  EXPECT_EQ(wild.outliers, 5U);
  EXPECT_NEAR(wild.contact_point_m, clean.contact_point_m,
              0.5 * clean.contact_point_sd_m);
}

TEST(ContactFit, FlagsAnEmptyRun) {
  Measurement m = synthetic({}, 7);
  for (double& force : m.force_n) {
    force = 0.01 * std::sin(1e4 * force);
  }
  const ContactFit result = fit(m);
  EXPECT_TRUE(result.has(FitFlag::kEmptyRun));
  EXPECT_TRUE(result.parameters.empty());
  Measurement constant = m;
  std::fill(constant.force_n.begin(), constant.force_n.end(), 0.25);
  EXPECT_TRUE(fit(constant).has(FitFlag::kEmptyRun));
}

TEST(ContactFit, FlagsContactFromTheFirstSample) {
  const ContactFit result = fit(synthetic({.exponent = 1.2, .free_m = 0.0}, 9));
  EXPECT_TRUE(result.has(FitFlag::kAlreadyInContact));
  EXPECT_TRUE(result.has(FitFlag::kContactPointNotIdentified));
  EXPECT_EQ(result.contact_point_m, 0.0);
  EXPECT_TRUE(std::isnan(result.contact_point_sd_m));
  EXPECT_NEAR(result.exponent, 1.2, 0.02);
}

TEST(ContactFit, HoldsAndNamesAParameterAtItsBound) {
  const ContactFit result = fit(synthetic({.exponent = 6.0}, 11));
  EXPECT_TRUE(result.has(FitFlag::kParameterAtBound));
  EXPECT_EQ(result.parameters[kExponent].held, "upper bound");
  EXPECT_EQ(result.exponent, 4.0);
  EXPECT_TRUE(std::isnan(result.parameters[kExponent].sd));
  EXPECT_TRUE(std::isfinite(result.contact_point_sd_m));
}

// A toe that rises straight by a tenth of the force, then a steep part that gives way:
// no power law, and with a drift of the toe's slope nearly one.
Measurement toe(double free_m, unsigned seed) {
  Measurement m = synthetic({.noise_n = 2e-3, .free_m = free_m, .samples = 120}, seed);
  const Measurement pure =
      synthetic({.noise_n = 0.0, .free_m = free_m, .samples = 120}, seed);
  for (std::size_t i = 0; i < m.force_n.size(); ++i) {
    const double d = std::max(0.0, m.depth_m[i] - free_m) / kSyntheticDepth;
    const double steep = std::max(0.0, d - 0.35);
    const double force =
        0.3 * d + 2.5 * std::min(steep, 0.3) + 0.5 * std::max(0.0, steep - 0.3);
    m.force_n[i] += force - pure.force_n[i];
  }
  return m;
}

TEST(ContactFit, TheEndOfAToeIsNoContactPoint) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const ContactFit at_once = fit(toe(0.0, seed));
    EXPECT_TRUE(at_once.has(FitFlag::kAlreadyInContact)) << seed;
    const ContactFit free = fit(toe(2e-3, seed));
    const bool told = std::abs(free.contact.m - 2e-3) <= 4.0 * free.contact.sd_m;
    EXPECT_TRUE(told || free.has(FitFlag::kContactPointNotIdentified)) << seed;
    ASSERT_TRUE(free.beginning) << seed;
    // Within a quarter of the toe, whose end is 1.75 mm away.
    EXPECT_NEAR(free.beginning->contact_point_m, 2e-3, 0.44e-3) << seed;
  }
}

// A wave of 2 % of the force over the depth, which no law has.
Measurement waved(double phase, unsigned seed) {
  const SyntheticCurve curve{.noise_n = 2e-3};
  Measurement m = synthetic(curve, seed);
  for (std::size_t i = 0; i < m.force_n.size(); ++i) {
    const double d = std::max(0.0, m.depth_m[i] - curve.free_m) / kSyntheticDepth;
    m.force_n[i] += 0.02 * std::sin(9.0 * d + phase) * std::pow(d, curve.exponent);
  }
  return m;
}

TEST(ContactFit, WhereTheLawMissesTheBeginningTellsTheContactPoint) {
  double law_m2 = 0.0, told_m2 = 0.0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const ContactFit result = fit(waved(0.5 * seed, seed));
    ASSERT_TRUE(result.beginning) << seed;
    const double apart_m = result.contact.m - result.contact_point_m;
    EXPECT_EQ(result.contact.m, result.beginning->contact_point_m) << seed;
    EXPECT_GE(result.contact.sd_m, std::abs(apart_m)) << seed;
    EXPECT_LE(std::abs(result.contact.m - 2e-3), 3.0 * result.contact.sd_m) << seed;
    law_m2 += std::pow(result.contact_point_m - 2e-3, 2);
    told_m2 += std::pow(result.contact.m - 2e-3, 2);
  }
  EXPECT_LT(told_m2, 0.5 * law_m2);
}

TEST(ContactFit, WhereTheLawFollowsItTellsTheContactPointItself) {
  const ContactFit result = fit(synthetic({}, 5));
  EXPECT_FALSE(result.beginning);
  EXPECT_EQ(result.contact.m, result.contact_point_m);
  EXPECT_EQ(result.contact.sd_m, result.contact_point_sd_m);
}

// A tilt that lifts the force by a third looks like a body from the first sample on,
// unless it is told that the first millimetre is free.
TEST(ContactFit, ABaselineTellsTiltFromTheBody) {
  const Measurement m = synthetic({.drift_n = 0.5}, 13);
  EXPECT_TRUE(fit(m).has(FitFlag::kAlreadyInContact));
  const ContactFit told = fit_contact(select_approach(m, {}, FitRange{0.0, 1e-3}));
  EXPECT_FALSE(told.has(FitFlag::kContactPointNotIdentified));
  EXPECT_NEAR(told.contact_point_m, 2e-3, 4.0 * told.contact_point_sd_m);
  EXPECT_NEAR(told.parameters[kBaselineSlope].value, 0.5 / 7e-3,
              4.0 * told.parameters[kBaselineSlope].sd);
}

TEST(ContactFit, ABaselineHoldsTheContactPointAtItsEndAndNamesIt) {
  const ContactFit told =
      fit_contact(select_approach(synthetic({}, 13), {}, FitRange{0.0, 2.5e-3}));
  EXPECT_NEAR(told.contact_point_m, 2.5e-3, 1e-9);
  EXPECT_EQ(told.parameters[kContact].held, "lower bound");
  EXPECT_TRUE(told.has(FitFlag::kParameterAtBound));
  EXPECT_TRUE(told.has(FitFlag::kContactPointNotIdentified));
}

TEST(ContactFit, ABaselineThatIsRightChangesNothing) {
  const Measurement m = synthetic({}, 13);
  const ContactFit told = fit_contact(select_approach(m, {}, FitRange{0.0, 1e-3}));
  // But for the drift that is expected to be small without one.
  EXPECT_NEAR(told.contact_point_m, fit(m).contact_point_m, 1e-6);
}

TEST(ContactFit, ABaselineMustLeaveSamplesForTheContact) {
  EXPECT_THROW(
      (void)select_approach(synthetic({}, 1), {}, FitRange{0.0, 6.95e-3}),  // 3 of 350
      InputError);
}

TEST(ContactFit, RefusesAnExponentOutOfRange) {
  EXPECT_THROW((void)fit(synthetic({}, 1), {0.5}), InputError);
  EXPECT_THROW((void)fit(synthetic({}, 1), {std::nan("")}), InputError);
}

// Straight line, where the textbook knows the covariance of offset and slope.
TEST(ContactCovariance, IsThatOfALineWhereTheContactIsHeld) {
  const ScaledCurve curve{{0.0, 0.25, 0.5, 0.75, 1.0}, {0.1, 0.2, 0.6, 0.7, 1.1}};
  const HeldParameters held{false, false, true, true, true};
  const double slope = 1.0, offset = 0.04;  // least squares by hand
  const auto covariance =
      contact_covariance(curve, {offset, slope, 1.0, 1.0, 1.0}, held);
  double squares = 0.0;
  for (std::size_t i = 0; i < 5; ++i) {
    squares += std::pow(offset + slope * curve.x[i] - curve.f[i], 2);
  }
  const double variance = squares / 3.0;
  EXPECT_NEAR(covariance(1, 1), variance / 0.625, 1e-15);
  EXPECT_NEAR(covariance(0, 0), variance * (1.0 / 5.0 + 0.25 / 0.625), 1e-15);
  EXPECT_EQ(covariance(2, 2), 0.0);
  // Five samples cannot tell a contact at the very end from none.
  EXPECT_TRUE(std::isnan(contact_covariance(curve, {offset, slope, 1.0, 1.5, 1.0},
                                            HeldParameters{})(0, 0)));
}

}  // namespace
}  // namespace palpate
