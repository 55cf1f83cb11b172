// The reference itself: its account of energy closes, and forces are those of Okamura's
// three parts.
#include "tests/fitting/insertion/needle_simulation.h"

#include <gtest/gtest.h>

#include "tests/fitting/insertion/random_needle.h"

namespace palpate {
namespace {

TEST(NeedleSimulation, WorkIsStoredOrSpentAndNothingIsCreated) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    RandomNeedle random = random_needle(seed);
    random.run.ticks = 5;
    SimulatedNeedle needle(random.tissue);
    static_cast<void>(simulate_insertion(needle, random.run, seed));
    const double spent =
        needle.stored() + needle.cut_j + needle.released_j + needle.friction_j;
    EXPECT_NEAR(needle.work_j, spent, 1e-12) << seed;
    EXPECT_GT(needle.cut_j, 0.0);
    EXPECT_GT(needle.released_j, 0.0);
    EXPECT_GT(needle.friction_j, 0.0);
    EXPECT_EQ(needle.rupture_m.size(), random.tissue.layers.size());
  }
}

// The first pass cuts L more than the second, which meets friction alone over L.
TEST(NeedleSimulation, TwoInsertionsDifferByCrackReleaseAndLaterFriction) {
  SimulatedTissue tissue;
  tissue.layers = {{0.0, 2.0, 0.5, 0.0}};  // no friction: works differ by the crack
  SimulatedNeedle needle(tissue);
  SimulatedRun run{.noise_n = 0.0};
  static_cast<void>(simulate_insertion(needle, run, 1));
  const double first = needle.work_j;
  EXPECT_NEAR(first, needle.cut_j + needle.released_j, 1e-12);
  EXPECT_NEAR(needle.cut_j, 0.5 * needle.channel_m, 1e-12);
}

}  // namespace
}  // namespace palpate
