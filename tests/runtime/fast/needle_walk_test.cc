// A needle that wanders in, out and aside: never any energy for the hand.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include <fmt/format.h>
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
  bool energies = false;  // break membranes below the skin
};

void PrintTo(const WalkCase& c, std::ostream* out) {
  *out << c.name;
}

class NeedleWalk : public testing::TestWithParam<WalkCase> {};

constexpr std::int64_t kBodyTicks = 50000;  // 25 s at 2 kHz

BenchBody walked_body(const WalkCase& c) {
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
  return punctured_body(options);
}

// A tip that wanders in, out and aside.
class WanderingTip {
 public:
  explicit WanderingTip(std::uint32_t seed) : random_(seed) {}

  Eigen::Vector3d after(double tick_s) {
    v_ = 0.995 * v_ +
         0.1 * std::sqrt(1 - 0.995 * 0.995) *
             Eigen::Vector3d(noise_(random_), noise_(random_), 3.0 * noise_(random_));
    const Eigen::Vector3d low(0.012, 0.012, -0.035), high(0.028, 0.028, 0.005);
    for (int i = 0; i < 3; ++i) {
      if ((x_(i) < low(i) && v_(i) < 0.0) || (x_(i) > high(i) && v_(i) > 0.0)) {
        v_(i) = -v_(i);
      }
    }
    x_ += v_ * std::min(tick_s, 0.002);
    return x_;
  }

 private:
  std::mt19937 random_;
  std::normal_distribution<double> noise_;
  Eigen::Vector3d x_{0.02, 0.02, 0.002};
  Eigen::Vector3d v_ = Eigen::Vector3d::Zero();
};

// What may only grow.
struct Dissipated {
  double crack_j = 0.0;
  double released_j = 0.0;
  double shaft_j = 0.0;
  double all_j = 0.0;
};

Dissipated dissipated(const FastState& state) {
  return {state.needle.crack_j, state.needle.released_j, state.needle.shaft_j,
          state.ledger.dissipated_j};
}

// Largest and smallest of all ticks of all bodies [J].
struct NeedleAccount {
  double open_j = 0.0;
  double created_j = 0.0;
  double lowest_work_j = 0.0;
  double shrunk_j = 0.0;  // a dissipation, in a tick
  std::uint64_t broken = 0;
  Dissipated dissipated = {};
};

void book(const Dissipated& before, const FastState& state, NeedleAccount& all) {
  const Dissipated now = dissipated(state);
  all.shrunk_j = std::max({all.shrunk_j, before.crack_j - now.crack_j,
                           before.released_j - now.released_j,
                           before.shaft_j - now.shaft_j, before.all_j - now.all_j});
  all.open_j = std::max(all.open_j, std::abs(imbalance_j(state.ledger)));
  all.created_j = std::max(all.created_j, state.ledger.created_j);
  all.lowest_work_j = std::min(all.lowest_work_j, state.ledger.work_j);
}

// A fresh body.
void walk_needle(const WalkCase& c, const BenchBody& body, std::uint32_t seed,
                 NeedleAccount& all) {
  PunctureRules rules = layered_rules();
  if (c.energies) {
    rules.material[1].membrane_j = 5e-4;
    rules.material[2].membrane_j = 2e-3;
  }
  const auto state = needle_state(rules);
  if (c.facets) {
    state->config.model = LocalModel::kFacets;
  }
  Account account;
  WanderingTip tip(seed);
  for (std::int64_t n = 0; n < kBodyTicks; ++n) {
    const double tick_s = c.late && n % 97 == 0 ? 0.05 : kTickS;
    const Eigen::Vector3d x = tip.after(tick_s);
    if (!c.late || n % 5 == 0) {
      send(*state, body, contact(*state).tool_m + (x - state->latest.position_m));
    }
    const Dissipated before = dissipated(*state);
    (void)account.step(*state, x, tick_s);
    ASSERT_EQ(state->safety.fault, Fault::kNone) << n;
    book(before, *state, all);
  }
  all.broken += state->needle.broken;
  const Dissipated end = dissipated(*state);
  all.dissipated.crack_j += end.crack_j;
  all.dissipated.released_j += end.released_j;
  all.dissipated.shaft_j += end.shaft_j;
  all.dissipated.all_j += end.all_j;
  if (!c.relaxes && !c.late) {
    ASSERT_NEAR(account.net_j, state->ledger.work_j, 1e-9);
  }
}

// Never any energy for the hand. The account of every body is open by rounding alone:
// sums of some 10 J, 50 000 times rounded.
TEST_P(NeedleWalk, CreatesNoEnergy) {
  const BenchBody body = walked_body(GetParam());
  const std::int64_t bodies =
      std::max<std::int64_t>(1, walk_ticks(200000) / kBodyTicks);
  NeedleAccount all;
  for (std::int64_t n = 0; n < bodies && !HasFatalFailure(); ++n) {
    walk_needle(GetParam(), body, static_cast<std::uint32_t>(7 + n), all);
  }
  RecordProperty("bodies", static_cast<int>(bodies));
  RecordProperty(
      "account",
      fmt::format("open {:.2g} J, created {:.2g} J, lowest work "
                  "{:.2g} J, shrunk {:.2g} J, {} membranes; crack "
                  "{:.3g} J, released {:.3g} J, shaft {:.3g} J of "
                  "{:.3g} J dissipated",
                  all.open_j, all.created_j, all.lowest_work_j, all.shrunk_j,
                  all.broken, all.dissipated.crack_j, all.dissipated.released_j,
                  all.dissipated.shaft_j, all.dissipated.all_j));
  EXPECT_LE(all.open_j, 1e-12);
  EXPECT_LE(all.created_j, 1e-12);
  EXPECT_EQ(all.lowest_work_j, 0.0);
  EXPECT_LE(all.shrunk_j, 1e-15);  // rounding of the last digit
  EXPECT_GT(all.broken, 10U * static_cast<std::uint64_t>(bodies));
  EXPECT_GT(all.dissipated.crack_j, 0.0);
  EXPECT_GT(all.dissipated.released_j, 0.0);
  EXPECT_GT(all.dissipated.shaft_j, 0.0);
}

INSTANTIATE_TEST_SUITE_P(
    All, NeedleWalk,
    testing::Values(WalkCase{"static", false, false, false, false},
                    WalkCase{"relaxing", true, false, false, false},
                    WalkCase{"yielding", false, true, false, false},
                    WalkCase{"both", true, true, false, false},
                    WalkCase{"facets", true, true, true, false},
                    WalkCase{"late", true, true, false, true},
                    WalkCase{"energies", true, true, false, false, true}),
    [](const auto& c) {
      return c.param.name;
    });

}  // namespace
}  // namespace palpate
