// A contact that slides over a body whose lateral stiffness differs by direction, depth
// and place: never any energy for the hand.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "runtime/bench/bench_walk.h"
#include "tests/runtime/fast/pressed_middle.h"
#include "tests/support/energy_account.h"
#include "tests/support/walk_ticks.h"

namespace palpate {
namespace {

struct SlidingCase {
  const char* name;
  bool facets = false;
  bool relaxes = false;
  bool yields = false;
  bool late = false;
};

void PrintTo(const SlidingCase& c, std::ostream* out) {
  *out << c.name;
}

class LateralWalk : public testing::TestWithParam<SlidingCase> {
 protected:
  static BenchBody sliding_body(const SlidingCase& c) {
    BenchBodyOptions options;
    options.wave_m = 0.003;
    options.contrast = 9.0;
    options.tilt_rad = 0.2;
    options.friction_min = 0.1;
    options.friction_max = 0.8;
    options.touch_offset_m = 0.0005;
    options.lateral = 4.0;
    if (c.relaxes) {
      options.relaxing = {0.3, 0.2};
      options.relaxation_s = {0.02, 0.3};
    }
    if (c.yields) {
      options.yielding = NodeYielding{.yield_depth_m = 0.002, .share = 0.3};
    }
    return make_bench_body(options);
  }

  // A fresh body and state, and irregular ticks of 50000 at most.
  void slide(const BenchBody& body, int ticks, std::uint32_t seed) {
    const SlidingCase& c = GetParam();
    auto state = std::make_unique<FastState>();
    state->config.model = c.facets ? LocalModel::kFacets : LocalModel::kPotential;
    state->config.tool_radius_m = 0.005;
    state->config.force_max_n = 1e9;
    state->config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
    Account account;
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit;
    int n = 0;
    for (const Eigen::Vector3d& x : make_bench_walk(
             body,
             {.ticks = ticks, .speed_m_per_s = 0.1, .lift_m = 0.004, .seed = seed})) {
      if (n++ % (c.late ? 20 : 4) == 0 && !(c.late && unit(random) < 0.3)) {
        send(*state, body, x);
      }
      const double dt_s = 0.0005 * (0.2 + 1.6 * unit(random));
      const FastCommand command = account.step(*state, x, dt_s);
      ASSERT_EQ(state->safety.fault, Fault::kNone) << n;
      ASSERT_TRUE(command.force_n.allFinite()) << n;
      by_body_ += state->potential.spring.by_body ? 1 : 0;
      least_j_ = std::min(least_j_, state->ledger.work_j);
    }
    open_j_ = std::max(open_j_, std::abs(imbalance_j(state->ledger)));
    created_j_ += state->ledger.created_j;
    dissipated_j_ += state->ledger.dissipated_j;
  }

  std::int64_t by_body_ = 0;
  double least_j_ = 0.0, open_j_ = 0.0, created_j_ = 0.0, dissipated_j_ = 0.0;
};

INSTANTIATE_TEST_SUITE_P(Bodies, LateralWalk,
                         testing::Values(SlidingCase{"static"},
                                         SlidingCase{"facets", true},
                                         SlidingCase{"relaxing", false, true},
                                         SlidingCase{"yielding", false, false, true},
                                         SlidingCase{"late", false, true, true, true}),
                         [](const auto& c) {
                           return std::string(c.param.name);
                         });

TEST_P(LateralWalk, CreatesNoEnergy) {
  constexpr std::int64_t kTicks = 50000;
  const BenchBody body = sliding_body(GetParam());
  std::uint32_t seed = 1;
  for (std::int64_t left = walk_ticks(2 * kTicks); left > 0; left -= kTicks) {
    slide(body, static_cast<int>(std::min(left, kTicks)), seed++);
    ASSERT_FALSE(HasFatalFailure());
  }
  EXPECT_GT(by_body_, walk_ticks(2 * kTicks) / 4);
  EXPECT_GT(dissipated_j_, 0.0);
  EXPECT_EQ(least_j_, 0.0);
  EXPECT_LE(open_j_, 1e-12);
  EXPECT_LE(created_j_, 1e-15);
  std::printf(
      "%-9s %lld ticks by the body's stiffness, least work %.1e J, account off by %.1e "
      "J, created %.1e J, dissipated %.3g J\n",
      GetParam().name, static_cast<long long>(by_body_), least_j_, open_j_, created_j_,
      dissipated_j_);
}

}  // namespace
}  // namespace palpate
