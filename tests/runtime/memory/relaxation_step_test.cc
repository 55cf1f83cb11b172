// The energy of a body that relaxes: no programme, however odd, gets any out of it.
#include "runtime/memory/relaxation_step.h"

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/relaxing_body.h"
#include "tests/support/walk_ticks.h"

namespace palpate {
namespace {

// u + V of a linear wall f = k d, in closed form: U = k d^2 / 2, U* = q^2 / (2 k).
long double stored_j(const FastState& state, long double stiffness,
                     long double depth_m) {
  const RelaxingContact& contact = state.potential.contact;
  long double s = 0.0L;
  long double squares = 0.0L;
  for (Eigen::Index k = 0; k < 2; ++k) {
    const long double q = contact.bundle[0].memory.relaxed_n.value(k);
    const long double g = contact.sites.place_relaxing.value(k);
    s += g * q;
    squares += g * q * q;
  }
  const long double above_m = std::max(0.0L, depth_m - s / stiffness);
  return 0.5L * stiffness * above_m * above_m + (squares - s * s) / (2.0L * stiffness);
}

TEST(RelaxationStep, NeverRaisesWhatAPlaceStoresWhateverTheClockDoes) {
  constexpr double kStiffness = 400.0;
  for (const PronyTerms2& terms :
       {kPork, kShortTimes, PronyTerms2{{0.4, 0.6}, {1e-6, 3.0}}}) {
    BenchBodyOptions options{.exponent = 1.0, .force_n = 3.2, .samples = 2};
    set_terms(options, terms);
    const BenchBody body = make_bench_body(options);
    PressedPlace place(body, LocalModel::kPotential, {0.031, 0.0306});
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit;
    double depth_m = -0.001;
    double target_m = 0.0;
    long double largest_rise_j = 0.0L;
    for (std::int64_t i = 0; i < walk_ticks(50000); ++i) {
      if (i % 400 == 0) {
        target_m = 0.007 * unit(random) - 0.0015;
      }
      double dt_s = 0.0005 * (0.2 + 1.6 * unit(random));
      dt_s = unit(random) < 1e-3 ? 0.02 * unit(random) : dt_s;
      dt_s = unit(random) < 1e-4 ? 1.0 : dt_s;
      depth_m += 0.02 * (target_m - depth_m);
      place.press(depth_m, dt_s);
      // Once more where it is: nothing but time passes.
      const long double before_j = stored_j(place.state(), kStiffness, depth_m);
      place.press(depth_m, dt_s);
      if (place.state().potential.contact.remembers) {
        const long double after_j = stored_j(place.state(), kStiffness, depth_m);
        largest_rise_j = std::max(largest_rise_j, after_j - before_j);
      }
      ASSERT_EQ(place.command().fault, 0) << i;
    }
    EXPECT_LE(largest_rise_j, 1e-18L) << terms.tau_s[0];
    EXPECT_GE(place.account().lowest_j, 0.0);
    EXPECT_NEAR(imbalance_j(place.state().ledger), 0.0, 1e-12);
    // By rounding alone.
    EXPECT_LE(place.state().memory.shortened_j, 1e-15) << terms.tau_s[0];
    EXPECT_EQ(place.state().ledger.created_j, 0.0);
  }
}

struct RelaxingWalkCase {
  double contrast = 1.0;
  PronyTerms2 terms;
  int bundles = 1;
  double friction = 0.0;
  LocalModel model = LocalModel::kPotential;
};

class RelaxingWalk : public testing::TestWithParam<RelaxingWalkCase> {
 protected:
  RelaxingWalk() {
    const RelaxingWalkCase& walk = GetParam();
    BenchBodyOptions options{.wave_m = 0.004,
                             .contrast = walk.contrast,
                             .tilt_rad = 0.2,
                             .friction_max = walk.friction,
                             .touch_offset_m = 3e-4,
                             .bundles = walk.bundles};
    set_terms(options, walk.terms);
    body_ = make_bench_body(options);
  }

  // Late ticks, late elements, teleports off the surface.
  void wander(int ticks) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> unit;
    int n = 0;
    for (const Eigen::Vector3d& x : make_bench_walk(
             body_, {.ticks = ticks, .speed_m_per_s = 0.1, .lift_m = 0.004})) {
      if (n++ % 20 == 0 && unit(random) >= 0.3) {
        send(*state_, body_, x);
      }
      double dt_s = 0.0005 * (0.2 + 1.6 * unit(random));
      dt_s = unit(random) < 1e-4 ? unit(random) : dt_s;
      relax_ahead(*state_, dt_s);
      const FastCommand command = account_.step(*state_, x, dt_s);
      contacts_ += command.in_contact ? 1 : 0;
      ASSERT_TRUE(command.force_n.allFinite()) << n;
      ASSERT_EQ(command.fault, 0) << n;
      ASSERT_GE(state_->ledger.dent_j, 0.0) << n;
      ASSERT_GE(state_->ledger.left_j, 0.0) << n;
    }
  }

  BenchBody body_;
  std::unique_ptr<FastState> state_ = free_state(GetParam().model, 0.005);
  Account account_;
  int contacts_ = 0;
};

INSTANTIATE_TEST_SUITE_P(
    Bodies, RelaxingWalk,
    testing::Values(RelaxingWalkCase{1.0, kPork}, RelaxingWalkCase{9.0, kPork},
                    RelaxingWalkCase{100.0, kPork, 1, 1.0},
                    RelaxingWalkCase{1.0, kShortTimes, 1, 0.5},
                    RelaxingWalkCase{100.0, kShortTimes},
                    RelaxingWalkCase{100.0, kShortTimes, 8, 0.5},
                    RelaxingWalkCase{9.0, {{0.4, 0.6}, {1e-5, 2.0}}, 1, 0.3},
                    RelaxingWalkCase{9.0, kPork, 1, 0.5, LocalModel::kElement},
                    RelaxingWalkCase{100.0, kShortTimes, 1, 0.5, LocalModel::kElement},
                    RelaxingWalkCase{9.0, kShortTimes, 1, 0.0, LocalModel::kEnergyTank},
                    RelaxingWalkCase{9.0, kPork, 1, 0.0, LocalModel::kEnergyTank},
                    RelaxingWalkCase{9.0, kPork, 1, 0.0, LocalModel::kEqualEnergy}));

TEST_P(RelaxingWalk, CreatesNoEnergy) {
  wander(40000);
  EXPECT_GT(contacts_, 10000);
  // 4e4 additions of energies below 0.1 J; outside of its element a place is found to
  // 1e-7 of the element's size again.
  EXPECT_GE(account_.lowest_j, -1e-11);
  EXPECT_GE(state_->ledger.work_j, 0.0);
  EXPECT_NEAR(imbalance_j(state_->ledger), 0.0, 1e-12);
  EXPECT_LE(state_->ledger.created_j, 1e-15);
}

// Stations over a triangle and its neighbours: corners, edges, centroid, at any depth,
// for a random time; as in a search for programmes that get energy out.
TEST(RelaxationAdversary, NoProgrammeOverATriangleGetsEnergyOut) {
  const std::array<Eigen::Vector2d, 7> places{Eigen::Vector2d(0.02, 0.02),
                                              Eigen::Vector2d(0.03, 0.02),
                                              Eigen::Vector2d(0.03, 0.03),
                                              Eigen::Vector2d(0.025, 0.02),
                                              Eigen::Vector2d(0.025, 0.025),
                                              Eigen::Vector2d(0.03, 0.025),
                                              Eigen::Vector2d(0.08 / 3.0, 0.07 / 3.0)};
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit;
  for (std::uint32_t programme = 1; programme <= 60; ++programme) {
    BenchBodyOptions options{.cells = 4,
                             .cell_m = 0.01,
                             .depth_m = 0.005,
                             .contrast = 31.6,
                             .seed = programme};
    set_terms(options, programme % 2 == 0 ? kPork : kShortTimes);
    const BenchBody body = make_bench_body(options);
    const auto state = free_state(LocalModel::kPotential, 0.0);
    Account account;
    int n = 0;
    const auto go = [&](const Eigen::Vector3d& x, double dt_s) {
      for (Element element : body.element) {
        element.active = element.triangle == body.triangle_at(x);
        if (n % 20 == 0) {
          accept(*state, element);
        }
      }
      ++n;
      relax_ahead(*state, dt_s);
      (void)account.step(*state, x, dt_s);
    };
    Eigen::Vector3d x(0.02, 0.02, 0.0005);
    for (int station = 0; station < 24; ++station) {
      const Eigen::Vector2d& at = places[random() % places.size()];
      const double z = unit(random) < 0.25 ? 0.0005 : -0.005 * unit(random);
      const Eigen::Vector3d to(at.x() + 1e-6, at.y() + 1e-6, z);
      const Eigen::Vector3d from = x;
      for (int i = 1; i <= 60; ++i) {
        x = from + i / 60.0 * (to - from);
        go(x, 0.0004);
      }
      const int late = static_cast<int>(6.0 * unit(random));
      for (int i = 0; i < 30; ++i) {
        go(x, i == late ? unit(random) : 0.01 * unit(random));
      }
    }
    EXPECT_GE(account.lowest_j, 0.0) << programme;
    EXPECT_GE(state->ledger.work_j, 0.0) << programme;
    EXPECT_NEAR(imbalance_j(state->ledger), 0.0, 1e-12) << programme;
    EXPECT_EQ(state->safety.fault, Fault::kNone) << programme;
  }
}

TEST(RelaxationAccount, AHoldDissipatesWhatTheDentDoesNotKeep) {
  BenchBodyOptions options{.exponent = 1.0, .force_n = 3.2, .samples = 2};
  set_terms(options, kShortTimes);
  const BenchBody body = make_bench_body(options);
  PressedPlace place(body, LocalModel::kPotential, {0.031, 0.0306});
  for (int i = 0; i < 20000; ++i) {
    place.press(std::min(0.005, 1e-5 * i), 0.0005);
  }
  // u = (1 - G)^2 f d / 2, V = (G - G^2) f d / 2.
  const double whole_j = 0.5 * 2.0 * 0.005;
  const PassivityLedger& ledger = place.state().ledger;
  EXPECT_NEAR(ledger.stored_j, 0.04 * whole_j, 1e-9);
  EXPECT_NEAR(ledger.dent_j, 0.16 * whole_j, 1e-9);
  EXPECT_GT(ledger.dissipated_j, 0.1 * whole_j);
}

TEST(RelaxationAccount, ASlowRetractGivesBackWhatTheDentKept) {
  BenchBodyOptions options{.exponent = 1.0, .force_n = 3.2, .samples = 2};
  set_terms(options, kShortTimes);
  const BenchBody body = make_bench_body(options);
  PressedPlace place(body, LocalModel::kPotential, {0.031, 0.0306});
  const auto at_m = [](int i) {
    return i < 40000 ? 1.25e-7 * i : std::max(-1e-4, 0.005 - 1.25e-7 * (i - 40000));
  };
  for (int i = 0; i < 90000; ++i) {
    place.press(at_m(i), 0.0005);
  }
  // Pressed and drawn back at 0.25 mm/s, 330 times slower than it relaxes: of the
  // (1 - G) f d / 2 = 1 mJ of the slow curve little is lost, and nothing is cut.
  EXPECT_LT(place.state().ledger.dissipated_j, 1e-4);
  EXPECT_EQ(place.state().memory.shortened, 0U);
  EXPECT_NEAR(place.state().ledger.stored_j, 0.0, 1e-12);
}

TEST(RelaxationAccount, WhatIsLeftBehindComesBackToHandOrGoes) {
  BenchBodyOptions options{.cell_m = 0.01};
  set_terms(options, kPork);
  const BenchBody body = make_bench_body(options);
  const auto state = free_state(LocalModel::kPotential, 0.0);
  int n = 0;
  const auto stay = [&](double x, double depth_m, double seconds) {
    const Eigen::Vector3d at(x, 0.0501, -depth_m);
    for (double t = 0.0; t < seconds; t += 0.005) {
      if (n++ % 4 == 0) {
        send(*state, body, at);
      }
      (void)step(*state, {at, 0}, 0.005);
    }
  };
  stay(0.05, 0.0, 0.1);
  stay(0.05, 0.004, 3.0);
  const double held_j = state->ledger.dent_j;
  EXPECT_GT(held_j, 1e-4);
  stay(0.05, -0.001, 0.05);
  EXPECT_EQ(state->ledger.dent_j, 0.0);
  EXPECT_GT(state->ledger.left_j, 0.9 * held_j);
  stay(0.05, 0.002, 0.05);
  EXPECT_GT(state->ledger.dent_j, 0.5 * held_j);
  stay(0.05, -0.001, 120.0);
  EXPECT_LT(state->ledger.left_j, 1e-4 * held_j);
  EXPECT_NEAR(imbalance_j(state->ledger), 0.0, 1e-15);
}

}  // namespace
}  // namespace palpate
