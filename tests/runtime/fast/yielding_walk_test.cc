// The energy of a body that yields: no walk gets any out of it.
#include <algorithm>
#include <cstdio>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/walk_ticks.h"
#include "tests/support/yielding_body.h"

namespace palpate {
namespace {

struct Walk {
  const char* name;
  NodeYielding yielding;
  double contrast = 1.0;
  LocalModel model = LocalModel::kPotential;
  PronyTerms2 terms = {};
  double friction = 0.0;
  bool late = false;  // elements come late, or not at all

  // Nothing but yielding changes the potential where the tool rests.
  [[nodiscard]] bool is_plain() const {
    return model == LocalModel::kPotential && !late && friction == 0.0 &&
           terms.tau_s[0] == 0.0;
  }
};

std::ostream& operator<<(std::ostream& out, const Walk& walk) {
  return out << walk.name;
}

// What walks over fresh bodies did, one after another.
struct WalkAccount {
  double rise_j = 0.0;    // of the potential in a tick in which the surface yields
  double lowest_j = 0.0;  // least work so far, of any
  double off_j = 0.0;     // largest distance of an account from its identity
  double created_j = 0.0;
  double tank_j = 0.0;
  double yielded_j = 0.0;
  std::uint64_t interventions = 0;
  std::int64_t contacts = 0;
  std::int64_t yields = 0;
  std::int64_t starved = 0;
};

class YieldingWalk : public testing::TestWithParam<Walk> {
 protected:
  YieldingWalk() {
    const Walk& walk = GetParam();
    BenchBodyOptions options{.wave_m = 0.004,
                             .contrast = walk.contrast,
                             .tilt_rad = 0.2,
                             .friction_max = walk.friction,
                             .touch_offset_m = 3e-4};
    if (walk.terms.tau_s[0] > 0.0) {
      set_terms(options, walk.terms);
    }
    body_ = mixed_body(options, walk.yielding);
  }

  // Irregular ticks over a fresh body.
  void wander(int ticks, std::uint32_t seed) {
    const auto state = free_state(GetParam().model, 0.005);
    Account account;
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit;
    int n = 0;
    for (const Eigen::Vector3d& x : make_bench_walk(
             body_,
             {.ticks = ticks, .speed_m_per_s = 0.1, .lift_m = 0.004, .seed = seed})) {
      // So often that the tool never leaves what has arrived; or late.
      if (n++ % (GetParam().late ? 20 : 4) == 0 &&
          !(GetParam().late && unit(random) < 0.3)) {
        send(*state, body_, x);
      }
      const double dt_s = 0.0005 * (0.2 + 1.6 * unit(random));
      relax_ahead(*state, dt_s);
      const double moved_j = potential_j(*state, x);
      const double yielded_j = state->ledger.yielded_j;
      const FastCommand command = account.step(*state, x, dt_s);
      if (command.yielded_j > yielded_j) {
        ++all_.yields;
        all_.rise_j = std::max(all_.rise_j, potential_j(*state, x) - moved_j);
      }
      all_.contacts += command.in_contact ? 1 : 0;
      all_.starved += command.starved ? 1 : 0;
      ASSERT_TRUE(command.force_n.allFinite() && command.fault == 0) << n;
    }
    add(state->ledger, account);
  }

  void add(const PassivityLedger& ledger, const Account& account) {
    EXPECT_GE(ledger.work_j, 0.0);
    all_.lowest_j = std::min(all_.lowest_j, account.lowest_j);
    all_.off_j = std::max(all_.off_j, std::abs(imbalance_j(ledger)));
    all_.created_j += ledger.created_j;
    all_.tank_j = std::max(all_.tank_j, ledger.tank_j);
    all_.yielded_j += ledger.yielded_j;
    all_.interventions += ledger.interventions;
  }

  BenchBody body_;
  WalkAccount all_;
};

constexpr NodeYielding kNothing{};

INSTANTIATE_TEST_SUITE_P(
    Bodies, YieldingWalk,
    testing::Values(
        Walk{"dents", kDenting}, Walk{"dents, contrast 100", kDenting, 100.0},
        Walk{"softening", kSoftening},
        Walk{"softening, contrast 100", kSoftening, 100.0}, Walk{"both", kBoth},
        Walk{"both, contrast 100", kBoth, 100.0},
        Walk{"friction", kBoth, 9.0, LocalModel::kPotential, {}, 0.5},
        Walk{"late", kBoth, 100.0, LocalModel::kPotential, {}, 0.5, true},
        Walk{"relaxing", kBoth, 9.0, LocalModel::kPotential, kPork, 0.3, true},
        Walk{"short times", kDenting, 100.0, LocalModel::kPotential, kShortTimes},
        Walk{"element", kBoth, 9.0, LocalModel::kElement, {}, 0.5, true},
        Walk{"element, relaxing", kBoth, 9.0, LocalModel::kElement, kPork, 0.3, true},
        Walk{"tank", kBoth, 9.0, LocalModel::kEnergyTank},
        Walk{"equal energy", kBoth, 9.0, LocalModel::kEqualEnergy},
        Walk{"nothing", kNothing, 9.0}));

TEST_P(YieldingWalk, CreatesNoEnergy) {
  const Walk& walk = GetParam();
  std::uint32_t seed = 1;
  for (std::int64_t left = walk_ticks(40000); left > 0; left -= 40000) {
    wander(static_cast<int>(std::min<std::int64_t>(left, 40000)), seed++);
  }
  EXPECT_GT(all_.contacts, 10000);
  // Outside of its element a place is found to 1e-7 of the element's size again. A
  // field that changes by less than 1e-15 J is taken for one (potential_model.cc): some
  // tens of times where nothing is dissipated.
  EXPECT_GE(all_.lowest_j, walk.late ? -1e-11 : -1e-13);
  EXPECT_LE(all_.off_j, 1e-12);
  EXPECT_LE(all_.created_j, 1e-15);
  if (follows_surface(walk.model) &&
      (walk.yielding.share > 0.0 || walk.yielding.largest > 0.0)) {
    EXPECT_GT(all_.yields, 1000);
  }
  if (walk.is_plain()) {
    EXPECT_LE(all_.rise_j, 1e-18);
    EXPECT_EQ(all_.starved, 0);
    EXPECT_EQ(all_.interventions, 0U);
    EXPECT_EQ(all_.tank_j, 0.0);
  }
  std::printf(
      "%-23s %lld of %lld ticks of contact yield; %.3g J by it, largest rise %.1e J, "
      "least work %.1e J, account off by %.1e J\n",
      walk.name, static_cast<long long>(all_.yields),
      static_cast<long long>(all_.contacts), all_.yielded_j, all_.rise_j, all_.lowest_j,
      all_.off_j);
}

}  // namespace
}  // namespace palpate
