#include "fitting/lateral/lateral_fit.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/fitting/lateral/random_loop.h"

namespace palpate {
namespace {

LateralFit fit_of_loop(const SimulatedContact& contact, const SimulatedMotion& motion,
                       unsigned seed = 5) {
  return fit_lateral({simulate_loop(contact, motion, seed).run});
}

bool has_note(const RunFit& run, const char* part) {
  return std::any_of(run.notes.begin(), run.notes.end(), [&](const std::string& note) {
    return note.find(part) != std::string::npos;
  });
}

// Without noise the sharp law comes back exactly. 200 springs are partial slip within
// 1 / 200^2.
TEST(LateralFit, NoiseFreeLoopsComeBack) {
  for (const bool partial_slip : {false, true}) {
    for (const bool sine : {false, true}) {
      const LateralFit fit = fit_of_loop({.partial_slip = partial_slip},
                                         {.sine = sine, .phase = 0.3, .offset_n = 0.2});
      const RunFit& run = fit.better.runs.front();
      const double share = partial_slip ? 2.5e-5 : 1e-8;
      EXPECT_EQ(fit.better.law,
                partial_slip ? ContactLaw::kPartialSlip : ContactLaw::kSharpSlip);
      EXPECT_NEAR(run.stiffness_n_per_m.value, 2000.0, 2000.0 * share);
      EXPECT_NEAR(fit.better.friction.value, 0.5, 0.5 * share);
      EXPECT_NEAR(run.presliding_m.value, 0.25e-3, 0.25e-3 * share);
      EXPECT_NEAR(run.offset_n, 0.2, 0.5 * share);
      EXPECT_TRUE(fit.laws_differ());
    }
  }
}

// Intervals hold the truth in 95 of 100: of 8 loops, 4 standard deviations.
TEST(LateralFit, TheTruthLiesWithinTheErrors) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    RandomLoop random = random_loop(seed);
    random.contact.instrument_n_per_m = 0.0;
    random.motion.noise_n = 0.03 * random.contact.slip_n();
    random.motion.rho = 0.5;
    random.motion.drift_n = 0.2 * random.contact.slip_n();
    const LateralFit fit = fit_of_loop(random.contact, random.motion, seed);
    const RunFit& run = fit.better.runs.front();
    const auto within = [&](const IntervalEstimate& e, double truth) {
      EXPECT_LT(std::abs(e.value - truth), 4.0 * e.sd) << seed;
      EXPECT_LT(e.sd, 0.1 * std::abs(truth)) << seed;
    };
    within(run.stiffness_n_per_m, random.contact.stiffness_n_per_m);
    within(fit.better.friction, random.contact.friction);
    within(run.presliding_m, random.contact.presliding_m());
  }
}

TEST(LateralFit, RunsShareTheFrictionCoefficient) {
  std::vector<LateralRun> runs;
  for (const double normal_n : {0.5, 1.0, 2.0}) {
    SimulatedContact contact{.stiffness_n_per_m = 2000.0 * std::cbrt(normal_n),
                             .normal_n = normal_n};
    runs.push_back(simulate_loop(contact, {.noise_n = 0.02}, 7).run);
  }
  const LateralFit fit = fit_lateral(runs);
  EXPECT_FALSE(fit.better.frictions_differ);
  EXPECT_NEAR(fit.better.friction.value, 0.5, 4.0 * fit.better.friction.sd);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const RunFit& run = fit.better.runs[i];
    EXPECT_LT(fit.better.friction.sd, run.friction.sd);
    EXPECT_NEAR(run.slip_force_n.value, fit.better.friction.value * run.normal_n,
                1e-12);
    EXPECT_LE(
        run.stiffness_n_per_m.sd,
        fit_lateral({runs[i]}).better.runs.front().stiffness_n_per_m.sd * 1.0000001);
  }
}

TEST(LateralFit, FrictionCoefficientsThatDifferStayApart) {
  std::vector<LateralRun> runs;
  for (const double friction : {0.4, 0.5}) {
    runs.push_back(simulate_loop({.friction = friction}, {.noise_n = 0.01}, 7).run);
  }
  const LateralFit fit = fit_lateral(runs);
  EXPECT_TRUE(fit.better.frictions_differ);
  EXPECT_NEAR(fit.better.runs[0].friction.value, 0.4, 0.01);
  EXPECT_NEAR(fit.better.runs[1].slip_force_n.value, 0.5, 0.01);
  EXPECT_GT(fit.better.friction.sd, 0.03);
}

TEST(LateralFit, WithoutANormalForceTheForceAloneIsKnown) {
  LateralRun run = simulate_loop({}, {.noise_n = 0.01}, 7).run;
  run.normal_n.clear();
  const RunFit fit = fit_lateral({run}).better.runs.front();
  EXPECT_NE(fit.friction.refused.find("--normal-force"), std::string::npos);
  EXPECT_NEAR(fit.slip_force_n.value, 0.5, 4.0 * fit.slip_force_n.sd);
  EXPECT_NEAR(fit.stiffness_n_per_m.value, 2000.0, 4.0 * fit.stiffness_n_per_m.sd);
  EXPECT_TRUE(fit.presliding_m.refused.empty());
}

TEST(LateralFit, AContactThatNeverSlidesHasALowerBound) {
  const LateralFit fit = fit_of_loop({}, {.amplitude_m = 0.2e-3, .noise_n = 0.005});
  const RunFit& run = fit.better.runs.front();
  EXPECT_NEAR(run.stiffness_n_per_m.value, 2000.0, 4.0 * run.stiffness_n_per_m.sd);
  EXPECT_NE(fit.better.friction.refused.find("never slides"), std::string::npos);
  // 2000 N/m times 0.2 mm of 1 N.
  EXPECT_LT(fit.better.friction.above, 0.4);
  EXPECT_GT(fit.better.friction.above, 0.38);
  EXPECT_LT(run.presliding_m.above, 0.2e-3 * 1.001);
  EXPECT_FALSE(run.presliding_m.refused.empty());
}

TEST(LateralFit, PartialSlipWithoutSlidingStillTellsTheStiffness) {
  const LateralFit fit =
      fit_of_loop({.partial_slip = true}, {.amplitude_m = 0.25e-3, .noise_n = 0.002});
  const RunFit& run = fit.better.runs.front();
  EXPECT_EQ(fit.better.law, ContactLaw::kPartialSlip);
  EXPECT_NEAR(run.stiffness_n_per_m.value, 2000.0, 4.0 * run.stiffness_n_per_m.sd);
  EXPECT_FALSE(run.friction.refused.empty());
  EXPECT_LT(run.friction.above, 0.5);
  EXPECT_GT(run.friction.above, 0.35);
}

TEST(LateralFit, SamplesFartherApartThanThePreslidingTellNoStiffness) {
  const RunFit run = fit_of_loop({.stiffness_n_per_m = 2e5},
                                 {.samples_per_cycle = 80, .noise_n = 0.005})
                         .better.runs.front();
  EXPECT_FALSE(run.stiffness_n_per_m.refused.empty());
  EXPECT_NEAR(run.friction.value, 0.5, 4.0 * run.friction.sd);
  // 2 S = 1 N within a step of 50 um or less.
  EXPECT_GT(run.stiffness_n_per_m.above, 1.9e4);
  EXPECT_LT(run.stiffness_n_per_m.above, 2e5);
}

TEST(LateralFit, HalfALoopTakesItsBeginningForZero) {
  const RunFit run = fit_of_loop({}, {.cycles = 0.25, .noise_n = 0.01, .offset_n = 0.7})
                         .better.runs.front();
  EXPECT_NEAR(run.stiffness_n_per_m.value, 2000.0, 4.0 * run.stiffness_n_per_m.sd);
  EXPECT_NEAR(run.friction.value, 0.5, 4.0 * run.friction.sd);
  EXPECT_NEAR(run.offset_n, 0.7, 0.01);
  EXPECT_TRUE(has_note(run, "taken for 0"));
  EXPECT_FALSE(run.loss_j.refused.empty());
}

// A normal force that relaxes takes friction and stiffness along.
TEST(LateralFit, ANormalForceMayRelax) {
  const RunFit run =
      fit_of_loop({}, {.noise_n = 0.01, .relaxes = 0.3}).better.runs.front();
  EXPECT_NEAR(run.friction.value, 0.5, 4.0 * run.friction.sd);
  // At the mean normal force, 0.85 N.
  EXPECT_NEAR(run.stiffness_n_per_m.value, 1700.0, 4.0 * run.stiffness_n_per_m.sd);
  EXPECT_FALSE(has_note(run, "differ"));
}

TEST(LateralFit, LoopsThatChangeAreWarnedOf) {
  LateralRun run =
      simulate_loop({}, {.cycles = 4.5, .noise_n = 0.01, .relaxes = 0.3}, 7).run;
  run.normal_n.clear();
  EXPECT_TRUE(has_note(fit_lateral({run}).better.runs.front(), "loops of the cycles"));
}

TEST(LateralFit, AnInstrumentsErrorIsInTheStiffness) {
  const LateralRun run =
      simulate_loop({.instrument_n_per_m = 4000.0}, {.noise_n = 0.005}, 7).run;
  const FrameCompliance exact = linear_frame(4000.0),
                        rough = linear_frame(4000.0, 400.0);
  const RunFit sure = fit_lateral({run}, &exact).better.runs.front();
  const RunFit unsure = fit_lateral({run}, &rough).better.runs.front();
  EXPECT_NEAR(sure.stiffness_n_per_m.value, 2000.0, 4.0 * sure.stiffness_n_per_m.sd);
  // dk/k = (k/k_i) dk_i/k_i = 0.5 * 0.1
  EXPECT_NEAR(unsure.stiffness_n_per_m.sd, 0.05 * 2000.0, 3.0);
  EXPECT_EQ(unsure.friction.sd, sure.friction.sd);
  // What the instrument takes off is not seen without it: 1/(1/2000 + 1/4000).
  EXPECT_NEAR(fit_lateral({run}).better.runs.front().stiffness_n_per_m.value, 1333.3,
              20.0);
}

TEST(LateralFit, NoiseAndATooSoftFrameTellNoStiffness) {
  LateralRun run = simulate_loop({}, {.noise_n = 0.01}, 7).run;
  const FrameCompliance soft = linear_frame(1500.0);
  const RunFit fit = fit_lateral({run}, &soft).better.runs.front();
  EXPECT_NE(fit.stiffness_n_per_m.refused.find("frame"), std::string::npos);
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  for (double& force : run.force_n) {
    force = normal(generator);
  }
  const RunFit noise = fit_lateral({run}).better.runs.front();
  EXPECT_FALSE(noise.friction.refused.empty());
}

TEST(LateralFit, NeedsARunAndAStraightFrame) {
  EXPECT_THROW((void)fit_lateral({}), InputError);
  FrameCompliance bent = linear_frame(1e4);
  bent.linear = false;
  EXPECT_THROW((void)fit_lateral({simulate_loop({}, {}, 1).run}, &bent), InputError);
}

}  // namespace
}  // namespace palpate
