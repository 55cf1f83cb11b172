#include "fitting/lateral/loop_loss.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/fitting/lateral/loop_simulation.h"

namespace palpate {
namespace {

LoopLosses losses_of(const SimulatedContact& contact, const SimulatedMotion& motion,
                     std::vector<double>* truth = nullptr) {
  const SimulatedLoop loop = simulate_loop(contact, motion, 3);
  const LateralPath path = find_lateral_path(loop.run);
  const ContactLaw law =
      contact.partial_slip ? ContactLaw::kPartialSlip : ContactLaw::kSharpSlip;
  if (truth != nullptr) {
    *truth = loop.loss_j;
  }
  return loop_losses(path, solve_loop(path, law, HUGE_VAL));
}

// Closed forms: 4 S (X - x_p) = 1.5 mJ and 4 S (X - 4/5 x_s) = 1.4 mJ. Eight pieces
// between samples of 10 um round a kink off by at most k (1.25 um)^2.
TEST(LoopLoss, IsThatOfTheClosedForm) {
  for (const bool partial_slip : {false, true}) {
    const LoopLosses losses =
        losses_of({.partial_slip = partial_slip}, {.cycles = 3.5, .phase = 0.4});
    ASSERT_EQ(losses.cycle.size(), 3U);
    for (const LoopCycle& cycle : losses.cycle) {
      EXPECT_NEAR(cycle.amplitude_m, 1e-3, 1e-12);
      EXPECT_NEAR(cycle.modelled_j, partial_slip ? 1.4e-3 : 1.5e-3, 1e-8);
      EXPECT_NEAR(cycle.measured_j, cycle.modelled_j, partial_slip ? 1e-7 : 1e-12);
    }
  }
}

TEST(LoopLoss, OfNoisyLoopsIsTheTruthWithinItsError) {
  std::vector<double> truth;
  const LoopLosses losses =
      losses_of({}, {.cycles = 4.5, .noise_n = 0.02, .offset_n = 0.3}, &truth);
  ASSERT_EQ(losses.cycle.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_GT(losses.cycle[i].sd_j, 0.0);
    EXPECT_NEAR(losses.cycle[i].measured_j, truth[i], 4.0 * losses.cycle[i].sd_j);
  }
  // White noise of 0.02 N over steps of 10 um: sqrt(400) of them.
  EXPECT_NEAR(losses.cycle[0].sd_j, 0.02 * 1e-5 * 20.0, 0.1 * 4e-6);
  EXPECT_LT(losses.chi_squared, 20.0);
}

TEST(LoopLoss, AHalfLoopLosesNothingThatIsKnown) {
  EXPECT_TRUE(losses_of({}, {.cycles = 0.5}).cycle.empty());
  EXPECT_TRUE(losses_of({}, {.cycles = 0.2}).cycle.empty());
}

}  // namespace
}  // namespace palpate
