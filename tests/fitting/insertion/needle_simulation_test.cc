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

// The channel is there: a second pass to the same depth cuts and releases nothing more.
TEST(NeedleSimulation, ASecondPassCutsNothing) {
  SimulatedTissue tissue;
  tissue.layers = {{0.0, 2.0, 0.5, 20.0}};
  SimulatedNeedle once(tissue), twice(tissue);
  static_cast<void>(simulate_insertion(once, {.noise_n = 0.0}, 1));
  static_cast<void>(
      simulate_insertion(twice, {.deepest_m = {25e-3, 25e-3}, .noise_n = 0.0}, 1));
  EXPECT_NEAR(once.cut_j, 0.5 * once.channel_m, 1e-12);
  EXPECT_NEAR(twice.cut_j, once.cut_j, 1e-12);
  EXPECT_NEAR(twice.released_j, once.released_j, 1e-12);
  EXPECT_GT(twice.friction_j, 1.9 * once.friction_j);
}

}  // namespace
}  // namespace palpate
