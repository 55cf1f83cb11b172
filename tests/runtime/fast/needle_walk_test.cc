// A needle that wanders in, out and aside: never any energy for the hand.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include <gtest/gtest.h>

#include "runtime/fast/fast_step.h"
#include "tests/support/energy_account.h"
#include "tests/support/layered_body.h"
#include "tests/support/tick.h"
#include "tests/support/walk_ticks.h"

namespace palpate {
namespace {

struct WalkCase {
  const char* name;
  bool relaxes;
  bool yields;
  bool facets;
  bool late;
};

void PrintTo(const WalkCase& c, std::ostream* out) {
  *out << c.name;
}

class NeedleWalk : public testing::TestWithParam<WalkCase> {};

// A tip that wanders in, out and aside: never any energy for the hand.
TEST_P(NeedleWalk, CreatesNoEnergy) {
  const WalkCase& c = GetParam();
  BenchBodyOptions options = layered_options();
  options.wave_m = 0.003;
  options.contrast = 3.0;
  options.tilt_rad = 0.2;
  options.friction_max = 0.5;
  if (c.relaxes) {
    options.relaxing = {0.3, 0.2};
    options.relaxation_s = {0.02, 0.3};
  }
  if (c.yields) {
    options.yielding = NodeYielding{.yield_depth_m = 0.004, .share = 0.3};
  }
  const BenchBody body = punctured_body(options);
  const auto state = needle_state();
  if (c.facets) {
    state->config.model = LocalModel::kFacets;
  }
  Account account;
  std::mt19937 random(7);
  std::normal_distribution<double> noise;
  Eigen::Vector3d x(0.02, 0.02, 0.002);
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  double dissipated = 0.0, open_j = 0.0, lowest_j = 0.0;
  double crack = 0.0, released = 0.0, shaft = 0.0;
  std::uint64_t punctures = 0;
  for (std::int64_t n = 0; n < walk_ticks(200000); ++n) {
    const double tick_s = c.late && n % 97 == 0 ? 0.05 : kTickS;
    v = 0.995 * v +
        0.1 * std::sqrt(1 - 0.995 * 0.995) *
            Eigen::Vector3d(noise(random), noise(random), 3.0 * noise(random));
    const Eigen::Vector3d low(0.012, 0.012, -0.035), high(0.028, 0.028, 0.005);
    for (int i = 0; i < 3; ++i) {
      if ((x(i) < low(i) && v(i) < 0.0) || (x(i) > high(i) && v(i) > 0.0)) {
        v(i) = -v(i);
      }
    }
    x += v * std::min(tick_s, 0.002);
    if (!c.late || n % 5 == 0) {
      send(*state, body, contact(*state).tool_m + (x - state->latest.position_m));
    }
    (void)account.step(*state, x, tick_s);
    const NeedleState& needle = state->needle;
    ASSERT_EQ(state->safety.fault, Fault::kNone) << n;
    ASSERT_GE(needle.crack_j, crack);
    ASSERT_GE(needle.released_j, released);
    ASSERT_GE(needle.shaft_j, shaft);
    ASSERT_GE(state->ledger.dissipated_j, dissipated - 1e-15);
    crack = needle.crack_j;
    released = needle.released_j;
    shaft = needle.shaft_j;
    dissipated = state->ledger.dissipated_j;
    open_j = std::max(open_j, std::abs(imbalance_j(state->ledger)));
    lowest_j = std::min(lowest_j, state->ledger.work_j);
    punctures = needle.broken;
  }
  EXPECT_GT(punctures, 10U);
  EXPECT_GT(crack, 0.0);
  EXPECT_GT(released, 0.0);
  EXPECT_GT(shaft, 0.0);
  EXPECT_EQ(lowest_j, 0.0);
  EXPECT_LT(open_j, 1e-12 * std::max(1.0, dissipated));  // rounding of the sums
  EXPECT_LT(state->ledger.created_j, 1e-12);
  if (!c.relaxes && !c.late) {
    EXPECT_NEAR(account.net_j, state->ledger.work_j, 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, NeedleWalk,
    testing::Values(WalkCase{"static", false, false, false, false},
                    WalkCase{"relaxing", true, false, false, false},
                    WalkCase{"yielding", false, true, false, false},
                    WalkCase{"both", true, true, false, false},
                    WalkCase{"facets", true, true, true, false},
                    WalkCase{"late", true, true, false, true}),
    [](const auto& c) {
      return c.param.name;
    });

}  // namespace
}  // namespace palpate
