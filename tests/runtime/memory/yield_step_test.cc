// Dents that stay and curves that soften: first presses are the stored response,
// what follows is elastic, and no programme gets energy out.
#include "runtime/memory/yield_step.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/yielding_body.h"

namespace palpate {
namespace {

BenchBodyOptions uneven() {
  return {.depth_m = 0.008, .samples = 25, .contrast = 9.0, .touch_offset_m = 2e-4};
}

class YieldStep : public testing::TestWithParam<LocalModel> {};

INSTANTIATE_TEST_SUITE_P(Models, YieldStep,
                         testing::Values(LocalModel::kPotential, LocalModel::kElement),
                         [](const auto& model) {
                           return std::string(name(model.param));
                         });

// Largest difference of a first press from the stored response, over its largest force.
double first_press_error(LocalModel model, const BenchBody& stored,
                         const BenchBody& yields, const Eigen::Vector2d& at,
                         double step_m) {
  PressedPlace still(stored, model, at);
  PressedPlace pressed(yields, model, at);
  double worst_n = 0.0;
  double largest_n = 0.0;
  for (double d = -2e-4; d < 0.0075; d += step_m) {
    const double wanted_n = still.press(d, 0.0005);
    worst_n = std::max(worst_n, std::abs(pressed.press(d, 0.0005) - wanted_n));
    largest_n = std::max(largest_n, wanted_n);
  }
  return worst_n / largest_n;
}

TEST_P(YieldStep, AFirstPressIsTheStoredResponseToRounding) {
  const BenchBody stored = make_bench_body(uneven());
  const BenchBody yields = mixed_body(uneven(), kDenting);
  for (const Eigen::Vector2d& at : kPressedPlaces) {
    EXPECT_LE(first_press_error(GetParam(), stored, yields, at, 1.3e-5), 1e-14)
        << at.transpose();
  }
}

TEST_P(YieldStep, AFirstPressOfASofteningBodyIsWithinItsCubics) {
  // Between its samples the undamaged curve is a cubic: 1e-6 of the largest force.
  const BenchBody stored = make_bench_body(uneven());
  for (const NodeYielding& around : {kSoftening, kBoth}) {
    const BenchBody yields = mixed_body(uneven(), around);
    for (const Eigen::Vector2d& at : kPressedPlaces) {
      EXPECT_LE(first_press_error(GetParam(), stored, yields, at, 1.3e-5), 2e-6)
          << at.transpose();
    }
  }
}

TEST(YieldStepSamples, AtItsSamplesASofteningFirstPressIsTheStoredForceToRounding) {
  BenchBodyOptions options{.depth_m = 0.008, .samples = 25};
  const BenchBody stored = make_bench_body(options);
  options.yielding = kBoth;
  const BenchBody yields = make_bench_body(options);
  PressedPlace place(yields, LocalModel::kElement, kPressedPlaces[3]);
  const ElementNode& node = stored.element[0].node[0];
  place.press(-1e-4, 0.0005);
  for (std::size_t i = 1; i < 24; ++i) {
    EXPECT_NEAR(place.press(node.depth_m[i], 0.0005), node.force_n[i], 2e-14) << i;
  }
}

TEST_P(YieldStep, WhatFollowsIsElasticFromTheDentOn) {
  BenchBodyOptions options{.depth_m = 0.008, .samples = 25};
  const ElementNode node = make_bench_body(options).element[0].node[0];
  options.yielding = kDenting;
  const BenchBody body = make_bench_body(options);
  for (const Eigen::Vector2d& at : kPressedPlaces) {
    PressedPlace place(body, GetParam(), at);
    const auto go = [&](double from_m, double to_m, const auto& check) {
      for (int i = 0; i <= 200; ++i) {
        const double d = from_m + (to_m - from_m) * i / 200;
        check(d, place.press(d, 0.0005));
      }
    };
    const auto first = [&](double d, double force_n) {
      EXPECT_NEAR(force_n, node.curve().at(d).force_n, 1e-14) << d;
    };
    const double dent_m = kDenting.share * (0.004 - kDenting.yield_depth_m);
    const auto elastic = [&](double d, double force_n) {
      const double e = d - dent_m;
      const double past_m = std::max(0.0, e - kDenting.yield_depth_m);
      const double l = std::min(e, kDenting.yield_depth_m) + past_m / (1.0 - 0.4);
      EXPECT_NEAR(force_n, node.curve().at(l).force_n, 1e-14) << d;
    };
    go(-1e-4, 0.004, first);
    EXPECT_NEAR(place.command().dent_m, dent_m, 1e-17);
    const double yielded_j = place.state().ledger.yielded_j;
    EXPECT_GT(yielded_j, 0.0);
    go(0.004, -1e-4, elastic);
    EXPECT_EQ(place.press(dent_m - 1e-9, 0.0005), 0.0);
    go(-1e-4, 0.004, elastic);
    // The same to rounding of the dent, which may grow by that.
    EXPECT_NEAR(place.state().ledger.yielded_j, yielded_j, 1e-16);
    go(0.004, 0.007, first);
    EXPECT_GT(place.state().ledger.yielded_j, 1.5 * yielded_j);
  }
}

TEST_P(YieldStep, ASoftenedResponseIsAShareOfTheUndamagedOne) {
  BenchBodyOptions options{.depth_m = 0.008, .samples = 25};
  const ElementNode node = make_bench_body(options).element[0].node[0];
  options.yielding = kSoftening;
  const BenchBody body = make_bench_body(options);
  const auto omega = [](double m) {
    return 0.5 * (1.0 - std::exp(-std::max(m - 0.001, 0.0) / 0.002));
  };
  PressedPlace place(body, GetParam(), kPressedPlaces[3]);
  for (int i = 0; i <= 100; ++i) {
    place.press(4e-5 * i, 0.0005);
  }
  for (int i = 0; i <= 200; ++i) {
    const double d = 0.004 * std::abs(1.0 - 0.01 * i);
    const double wanted_n =
        (1.0 - omega(0.004)) * node.curve().at(d).force_n / (1.0 - omega(d));
    EXPECT_NEAR(place.press(d, 0.0005), wanted_n, 2e-6) << d;
  }
}

TEST_P(YieldStep, APressDissipatesWhatItDoesNotGiveBack) {
  BenchBodyOptions options{.exponent = 1.0, .force_n = 3.2, .samples = 2};
  options.yielding = kDenting;
  const BenchBody body = make_bench_body(options);
  PressedPlace place(body, GetParam(), kPressedPlaces[3]);
  for (int i = 0; i <= 1000; ++i) {
    place.press(5e-6 * i, 0.0005);
  }
  // f = 400 d: U_e = 400 (d_y^2 / 2 + (1 - r) (d^2 - d_y^2) / 2), work = 400 d^2 / 2 to
  // the ticks' first order, 400 d dD / 2.
  const PassivityLedger& ledger = place.state().ledger;
  const double kept_j = 200.0 * (1e-6 + 0.6 * (25e-6 - 1e-6));
  EXPECT_NEAR(ledger.stored_j, kept_j, 1e-17);
  EXPECT_NEAR(ledger.dissipated_j, 200.0 * 25e-6 - kept_j, 1e-5);
  EXPECT_EQ(ledger.dissipated_j, ledger.yielded_j);
  EXPECT_NEAR(imbalance_j(ledger), 0.0, 1e-17);
}

TEST(YieldStepSites, NoSiteIsDeeperThanThePress) {
  BenchBodyOptions options;
  options.yielding = kDenting;
  const BenchBody body = make_bench_body(options);
  const auto state = free_state(LocalModel::kPotential, 0.0);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit;
  double deepest_m = 0.0;
  for (int press = 0; press < 300; ++press) {
    const Eigen::Vector2d at(0.01 + 0.04 * unit(random), 0.01 + 0.04 * unit(random));
    const double depth_m = 0.006 * unit(random);
    deepest_m = std::max(deepest_m, depth_m);
    for (int i = 0; i < 40; ++i) {
      const double d = depth_m * std::min(1.0, i / 30.0) - (i == 39 ? 0.02 : 0.0);
      const Eigen::Vector3d x(at.x(), at.y(), -d);
      send(*state, body, x);
      const FastCommand command = step(*state, {x, 0}, 0.0005);
      if (i == 38 && command.in_contact) {
        // Where others pressed deeper it may be more, never less.
        EXPECT_GE(command.dent_m, (1.0 - 1e-14) * 0.4 * std::max(0.0, depth_m - 0.001));
      }
    }
  }
  for (const YieldedSite& site : state->memory.yielded.row) {
    EXPECT_LE(site.dent_m, (1.0 + 1e-14) * 0.4 * (deepest_m - 0.001));
  }
  EXPECT_EQ(state->memory.yielded.refused, 0U);
}

TEST(YieldStepSites, AFullTableKeepsWhatThereIsAndYieldsNoFurther) {
  YieldedSites sites;
  for (std::int32_t i = 0; i < kYieldedSites; ++i) {
    ASSERT_GE(claim_yielded(sites, 7 + i * 64), 0) << i;
  }
  EXPECT_EQ(sites.count, kYieldedSites);
  EXPECT_EQ(claim_yielded(sites, 1), -1);
  EXPECT_EQ(find_yielded(sites, 1), -1);
  EXPECT_EQ(sites.refused, 1U);
  EXPECT_GE(find_yielded(sites, 7 + 64), 0);
}

TEST(YieldStepSites, APlaceWithoutARowStaysAsItIs) {
  BenchBodyOptions options;
  const BenchBody stored = make_bench_body(options);
  options.yielding = kBoth;
  const BenchBody body = make_bench_body(options);
  PressedPlace place(body, LocalModel::kPotential, kPressedPlaces[3]);
  YieldedSites& sites = place.state().memory.yielded;
  for (int i = 0; i < kYieldedSites; ++i) {
    sites.row[static_cast<std::size_t>(i)] = {.site = 1'000'000 + i, .dent_m = 0.001};
  }
  for (int i = 0; i < 1000; ++i) {
    place.press(std::abs(5e-6 * (500 - i)), 0.0005);
  }
  EXPECT_GT(sites.refused, 0U);
  EXPECT_EQ(place.command().dent_m, 0.0);
  EXPECT_EQ(place.state().ledger.yielded_j, 0.0);
  EXPECT_NEAR(place.account().net_j, place.state().ledger.stored_j, 1e-17);
  EXPECT_TRUE(std::all_of(sites.row.begin(), sites.row.end(), [](const auto& row) {
    return row.dent_m == 0.001;
  }));
}

// Elements that come anew, late, or not at all, other elements in all slots: the dent
// stays and with it the energy.
TEST(YieldStepElements, NoElementTakesADentAway) {
  BenchBodyOptions options;
  options.yielding = kBoth;
  const BenchBody body = make_bench_body(options);
  for (const LocalModel model : {LocalModel::kPotential, LocalModel::kElement}) {
    PressedPlace place(body, model, kPressedPlaces[3]);
    for (int i = 0; i <= 100; ++i) {
      place.press(4e-5 * i, 0.0005);
    }
    FastState& state = place.state();
    const double held_n = place.press(0.0035, 0.0005);
    const double stored_j = state.ledger.stored_j;
    for (int round = 0; round < 50; ++round) {
      // Everything else of the body goes through the cache, and this element again.
      for (const Element& element : body.element) {
        accept(state, element);
      }
      ASSERT_NEAR(place.press(0.0035, 0.0005), held_n, 1e-15) << round;
      ASSERT_NEAR(state.ledger.stored_j, stored_j, 1e-18) << round;
    }
    EXPECT_EQ(state.ledger.created_j, 0.0);
    EXPECT_EQ(state.ledger.tank_j, 0.0);
  }
}

// Force is the gradient of the potential, the dent's walls included.
TEST(YieldStepGradient, ForcesAreThePotentialsGradient) {
  for (const NodeYielding& around : {kDenting, kSoftening, kBoth}) {
    BenchBodyOptions options{.wave_m = 0.004, .contrast = 9.0, .touch_offset_m = 3e-4};
    for (const bool relaxing : {false, true}) {
      if (relaxing) {
        set_terms(options, kShortTimes);
      }
      const BenchBody body = mixed_body(options, around);
      const auto state = free_state(LocalModel::kPotential, 0.005);
      int n = 0;
      double worst = 0.0;
      for (const Eigen::Vector3d& x :
           make_bench_walk(body, {.ticks = 30000, .lift_m = 0.004})) {
        if (n++ % 20 == 0) {
          send(*state, body, x);
        }
        const FastCommand command = step(*state, {x, 0}, 0.0005);
        if (n % 97 != 0 || !command.in_contact) {
          continue;
        }
        constexpr double kH = 1e-8;
        Eigen::Vector3d slope;
        for (int i = 0; i < 3; ++i) {
          const Eigen::Vector3d h = kH * Eigen::Vector3d::Unit(i);
          slope(i) =
              (potential_j(*state, x + h) - potential_j(*state, x - h)) / (2 * kH);
        }
        worst = std::max(
            worst, (command.force_n + slope).norm() / (command.force_n.norm() + 0.01));
      }
      // Central differences: rounding 1e-17 J over 1e-8 m, and kinks of the field.
      EXPECT_LE(worst, 1e-5) << relaxing;
    }
  }
}

}  // namespace
}  // namespace palpate
