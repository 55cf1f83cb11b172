// Stepwise relaxation: one law over all ramps and holds.
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "fitting/curve/segments.h"
#include "fitting/curve/time_effects.h"
#include "tests/support/staircase.h"

namespace palpate {
namespace {

constexpr double kStep = 4.95e-4, kFirst = kStep + Staircase::kFree;
constexpr double kDeviations = 4.0;

void expect_law(const JointRelaxation& found) {
  ASSERT_EQ(found.refused, "");
  ASSERT_EQ(found.terms.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    const RelaxationTerm& term = found.terms[k];
    EXPECT_NEAR(term.g, Staircase::kG[k], kDeviations * term.g_sd) << k;
    EXPECT_LT(term.g_sd, 0.02 * term.g) << k;
    EXPECT_NEAR(term.tau_s, Staircase::kTau[k], kDeviations * term.tau_sd_s) << k;
    EXPECT_LT(term.tau_sd_s, 0.05 * term.tau_s) << k;
  }
  const double deepest =
      Staircase::kStiffness * (found.displacement_m.back() - Staircase::kFree);
  EXPECT_NEAR(found.force_n.back(), deepest, kDeviations * found.force_sd_n.back());
  EXPECT_LT(found.force_sd_n.back(), 0.01 * deepest);
}

JointRelaxation fitted_run(const Staircase& stairs, unsigned seed = 1) {
  return find_relaxation(stairs.make(seed)).joint;
}

TEST(SeveralHolds, AreFittedTogetherWhicheverIsLongest) {
  for (const auto& hold_s :
       {std::array{240.0, 420.0, 720.0}, std::array{720.0, 420.0, 240.0},
        std::array{300.0, 300.0, 300.0}}) {
    for (const double speed : {1e-4, 1e-3}) {
      SCOPED_TRACE(testing::Message() << hold_s[0] << " s, " << speed << " m/s");
      const JointRelaxation found = fitted_run(
          {{{kFirst, hold_s[0]}, {kStep, hold_s[1]}, {kStep, hold_s[2]}}, speed});
      EXPECT_EQ(found.holds, 3U);
      EXPECT_EQ(found.holds_used, 3U);
      EXPECT_NEAR(found.displacement_m.back(), kFirst + 2 * kStep, 1e-9);
      expect_law(found);
    }
  }
}

TEST(SeveralHolds, OneBeforeContactIsFoundAndNotUsed) {
  const JointRelaxation found = fitted_run(
      {{{2e-4, 60.0}, {kFirst - 2e-4, 240.0}, {kStep, 420.0}, {kStep, 720.0}}});
  EXPECT_EQ(found.holds, 4U);
  EXPECT_EQ(found.holds_used, 3U);
  EXPECT_NE(describe(found).find("3 of 4 holds"), std::string::npos);
  expect_law(found);
}

TEST(SeveralHolds, AStepBackIsFollowed) {
  for (const Staircase& stairs :
       {Staircase{
            {{kFirst + kStep, 300.0}, {-0.5 * kStep, 300.0}, {1.5 * kStep, 300.0}}},
        Staircase{
            {{kFirst + kStep, 720.0}, {-0.5 * kStep, 300.0}, {0.5 * kStep, 300.0}}}}) {
    const JointRelaxation found = fitted_run(stairs);
    EXPECT_EQ(found.holds, 3U);
    EXPECT_EQ(found.holds_used, 3U);
    expect_law(found);
  }
}

TEST(SeveralHolds, AStepBackThatSticksIsLeftOut) {
  Measurement m =
      Staircase{{{kFirst + kStep, 720.0}, {-0.5 * kStep, 300.0}, {0.5 * kStep, 300.0}}}
          .make(1);
  for (std::size_t i = 0; i < m.time_s.size(); ++i) {
    m.force_n[i] -= m.time_s[i] > 733.0 ? 0.03 : 0.0;
  }
  const JointRelaxation found = find_relaxation(m).joint;
  EXPECT_EQ(found.holds, 3U);
  EXPECT_EQ(found.holds_used, 1U);
  EXPECT_FALSE(found.release);
  expect_law(found);
}

TEST(SeveralHolds, ThoseOfAFewSamplesCount) {
  const JointRelaxation found =
      fitted_run({{{kFirst, 8.0}, {kStep, 8.0}, {kStep, 900.0}}, 2e-5, 1.0, 3e-4});
  EXPECT_EQ(found.holds, 3U);
  EXPECT_EQ(found.holds_used, 3U);
  expect_law(found);
}

// The longest one in which the force falls: not that after a step back.
TEST(SeveralHolds, TheHoldThatIsStatedAloneFalls) {
  const Relaxation found = find_relaxation(
      Staircase{{{kFirst + kStep, 300.0}, {-0.5 * kStep, 310.0}, {kStep, 200.0}}}.make(
          1));
  ASSERT_EQ(found.refused, "");
  EXPECT_NEAR(found.seconds, 300.0, 2.0);
  EXPECT_NEAR(found.speed_m_per_s, 1e-4, 1e-5);
}

TEST(SeveralHolds, WhatIsSeenIsByTheTimeInMotion) {
  const JointRelaxation one = fitted_run({{{kFirst + 2 * kStep, 600.0}}});
  const JointRelaxation three =
      fitted_run({{{kFirst, 600.0}, {kStep, 600.0}, {kStep, 600.0}}});
  EXPECT_LT(three.seen_from_s, 1.5 * one.seen_from_s);
}

TEST(SeveralHolds, SpeedOfThePressLeavesHoldsOut) {
  const Relaxation found = find_relaxation(
      Staircase{{{kFirst, 240.0}, {kStep, 240.0}, {kStep, 720.0}}}.make(1));
  EXPECT_NEAR(found.speed_m_per_s, 1e-4, 1e-5);
}

}  // namespace
}  // namespace palpate
