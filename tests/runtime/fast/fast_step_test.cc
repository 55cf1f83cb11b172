#include "runtime/fast/fast_step.h"

#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "runtime/bench/bench_body.h"
#include "tests/runtime/fast/pressed_middle.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/energy_account.h"
#include "tests/support/tick.h"

namespace palpate {
namespace {

struct WalkResult {
  double lowest_net_j = 0.0;
  double force_max_n = 0.0;
  double tank_min_j = 0.0;
  int contacts = 0;
  int starved = 0;
  int elements = 0;
};

// Renders a walk; the slow process skips its turn with probability `lost`.
WalkResult walk(const BenchBody& body, FastState& state, int ticks, double lost) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform;
  Account account;
  WalkResult result;
  std::int32_t last = -1;
  int tick = 0;
  const BenchWalkOptions options{.ticks = ticks,
                                 .tool_radius_m = state.config.tool_radius_m};
  for (const Eigen::Vector3d& x : make_bench_walk(body, options)) {
    if (tick++ % 20 == 0 && uniform(random) >= lost) {
      send(state, body, x);
    }
    const FastCommand command = account.step(state, x);
    result.force_max_n = std::max(result.force_max_n, command.force_n.norm());
    result.tank_min_j = std::min(result.tank_min_j, command.tank_j);
    result.contacts += command.in_contact ? 1 : 0;
    result.starved += command.starved ? 1 : 0;
    result.elements += contact(state).triangle != last ? 1 : 0;
    last = contact(state).triangle;
  }
  result.lowest_net_j = account.lowest_j;
  return result;
}

BenchBodyOptions random_body() {
  BenchBodyOptions options;
  options.wave_m = 0.004;
  options.contrast = 9.0;
  options.tilt_rad = 0.2;
  options.friction_max = 1.0;
  options.touch_offset_m = 3e-4;
  return options;
}

TEST(FastStep, MillionRandomTicksOnARandomBodyCreateNoEnergy) {
  const BenchBody body = make_bench_body(random_body());
  FastState state = element_state();
  const WalkResult r = walk(body, state, 1000000, 0.3);
  EXPECT_EQ(state.safety.fault, Fault::kNone);
  // 1e6 additions of energies below 0.02 J, each rounded at 2e-18 J.
  EXPECT_GE(r.lowest_net_j, -1e-11);
  EXPECT_NEAR(imbalance_j(state.ledger), 0.0, 1e-11);
  EXPECT_GE(r.tank_min_j, 0.0);
  EXPECT_LT(state.ledger.created_j, 1e-11);
  // The stiffest node gives 6 N at 8 mm; friction at most as much again.
  EXPECT_LT(r.force_max_n, 20.0);
  EXPECT_GT(r.contacts, 300000);
  EXPECT_GT(r.elements, 1000);
  EXPECT_GT(r.starved, 100);
}

TEST(FastStep, FrictionlessWalkOnARandomBodyCreatesNoEnergy) {
  BenchBodyOptions options = random_body();
  options.friction_max = 0.0;
  const BenchBody body = make_bench_body(options);
  FastState state = element_state();
  const WalkResult r = walk(body, state, 200000, 0.3);
  EXPECT_EQ(state.safety.fault, Fault::kNone);
  EXPECT_GE(r.lowest_net_j, -1e-11);
  EXPECT_GT(r.contacts, 50000);
}

TEST(FastStep, ScalarModelsWalkPassivelyToo) {
  const BenchBody body = make_bench_body(random_body());
  for (const LocalModel model : {LocalModel::kEqualEnergy, LocalModel::kEnergyTank}) {
    FastState state = element_state();
    state.config.model = model;
    const WalkResult r = walk(body, state, 200000, 0.3);
    EXPECT_EQ(state.safety.fault, Fault::kNone) << name(model);
    EXPECT_GE(r.lowest_net_j, -1e-11) << name(model);
    EXPECT_GT(r.force_max_n, 0.1) << name(model);
  }
}

TEST(FastStep, AllocatesNothing) {
  const BenchBody body = make_bench_body(random_body());
  const std::vector<Eigen::Vector3d> path =
      make_bench_walk(body, {.ticks = 20000, .tool_radius_m = 0.005});
  for (const LocalModel model : kLocalModels) {
    FastState state = element_state();
    state.config.model = model;
    std::uint64_t allocations = 0;
    for (std::size_t tick = 0; tick < path.size(); ++tick) {
      const std::vector<Element> messages =
          tick % 20 == 0 ? body.around(path[tick]) : std::vector<Element>{};
      const test::AllocationGuard guard;
      for (const Element& element : messages) {
        accept(state, element);
      }
      (void)step(state, {path[tick], 0}, kTickS);
      (void)contact(state);
      allocations += guard.count();
    }
    EXPECT_EQ(allocations, 0U) << name(model);
  }
}

TEST(AllocationGuard, CountsNewMallocAndDynamicMatrices) {
  const test::AllocationGuard guard;
  const auto owned = std::make_unique<int>(3);
  EXPECT_EQ(guard.count(), 1U);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const Eigen::VectorXd vector = Eigen::VectorXd::Constant(100, *owned);
  EXPECT_EQ(guard.count(), 2U) << vector.sum();
#endif
}

TEST(FastStep, StraightPokeRendersTheCurve) {
  const BenchBody body = make_bench_body({.exponent = 2.0, .friction_max = 0.5});
  FastState state = pressed(body, over_middle(body, -0.001));
  for (double depth = -0.001; depth < 0.007; depth += 1e-5) {
    const FastCommand command = step(state, {over_middle(body, depth), 0}, kTickS);
    const double wanted = body.element[0].node[0].curve().at(depth).force_n;
    EXPECT_NEAR(command.force_n.z(), wanted, 1e-12);
    EXPECT_NEAR(command.force_n.head<2>().norm(), 0.0, 1e-12);
    EXPECT_EQ(command.in_contact, depth > 0.0);
  }
}

TEST(FastStep, ForceIsContinuousAcrossEdges) {
  BenchBodyOptions options = random_body();
  options.friction_max = 0.0;
  const BenchBody body = make_bench_body(options);
  FastState state = element_state();
  const auto at = [&](double along) {
    const Eigen::Vector3d over(0.3 * body.side_m() + along, 0.52 * body.side_m(), 0.0);
    return Eigen::Vector3d(over.x(), over.y(), 0.005 - 0.004);
  };
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  int crossings = 0;
  std::int32_t triangle = -1;
  constexpr double kStepM = 1e-6;
  for (int n = 0; n < 20000; ++n) {
    const Eigen::Vector3d x = at(n * kStepM);
    if (n % 20 == 0) {
      send(state, body, x);
    }
    const FastCommand command = step(state, {x, 0}, kTickS);
    if (n > 1) {
      // Slopes below 6 N / 8 mm and directions turning less than 1 rad / 5 mm.
      EXPECT_LT((command.force_n - before).norm(), 5e3 * kStepM) << n;
      crossings += contact(state).triangle != triangle ? 1 : 0;
    }
    triangle = contact(state).triangle;
    before = command.force_n;
  }
  EXPECT_GE(crossings, 5);
}

TEST(FastStep, SlidingFrictionIsCoulombs) {
  const BenchBody body = make_bench_body({.friction_min = 0.4, .friction_max = 0.4});
  FastState state = pressed(body, over_middle(body, -0.001));
  Eigen::Vector3d x = over_middle(body, -0.0005);
  FastCommand command;
  for (int n = 0; n < 9000; ++n) {
    if (n < 4500) {
      x.z() -= 1e-6;
    } else {
      x.x() += 1e-6;
    }
    if (n % 20 == 0) {
      send(state, body, x);
    }
    command = step(state, {x, 0}, kTickS);
  }
  EXPECT_NEAR(command.force_n.x(), -0.4 * command.force_n.z(), 1e-9);
  EXPECT_GT(command.dissipated_j, 0.0);
}

// The cycle: pull sideways at depth a, press to b, return sideways, release to a.
struct Cycle {
  double a_m = 0.002;
  double b_m = 0.006;
  double aside_m = 0.0005;
  int steps = 200;
  template <typename Visit>
  void run(Visit visit) const {
    const auto leg = [&](double x0, double d0, double x1, double d1) {
      for (int i = 1; i <= steps; ++i) {
        const double t = static_cast<double>(i) / steps;
        visit(x0 + t * (x1 - x0), d0 + t * (d1 - d0));
      }
    };
    leg(0.0, a_m, aside_m, a_m);
    leg(aside_m, a_m, aside_m, b_m);
    leg(aside_m, b_m, 0.0, b_m);
    leg(0.0, b_m, 0.0, a_m);
  }
};

TEST(FrictionSpring, NaiveOneGivesEnergyAwayInALateralPressCycle) {
  const BenchBody body = make_bench_body({.exponent = 2.0});
  const CurveView curve = body.element[0].node[0].curve();
  constexpr double kMu = 0.5;
  const Cycle cycle;
  double work_j = 0.0;  // done on the spring by the tool, trapezoid
  double x = 0.0;
  double f = 0.0;
  cycle.run([&](double to, double depth) {
    const double f_to = kMu * curve.at(depth).force_n * to / cycle.aside_m;
    work_j += 0.5 * (f + f_to) * (to - x);
    x = to;
    f = f_to;
  });
  const double gain_j = 0.5 * kMu * cycle.aside_m *
                        (curve.at(cycle.b_m).force_n - curve.at(cycle.a_m).force_n);
  EXPECT_NEAR(-work_j, gain_j, 1e-9 * gain_j);
}

TEST(FrictionSpring, LedgerKeepsALateralPressCyclePassive) {
  const BenchBody body =
      make_bench_body({.exponent = 2.0, .friction_min = 0.5, .friction_max = 0.5});
  const Cycle cycle;
  FastState state = pressed(body, over_middle(body, -0.001));
  Account account;
  account.step(state, over_middle(body, -0.001));
  account.step(state, over_middle(body, cycle.a_m));
  for (int turn = 0; turn < 5; ++turn) {
    const double before_j = account.net_j;
    cycle.run([&](double aside, double depth) {
      // Just inside delta_L: nothing slides, only the ledger can lose energy.
      const Eigen::Vector3d offset(0.999 * aside, 0.0, 0.0);
      account.step(state, over_middle(body, depth) + offset);
    });
    EXPECT_GE(account.net_j - before_j, -1e-15) << turn;
  }
  EXPECT_EQ(state.safety.fault, Fault::kNone);
}

// The slow value of a scalar model begins where the first node that has a response is
// touched: on a linear body the tank's curve is that line, also on the way out.
TEST(FastStep, TheTankBeginsWhereANodeWithAResponseIsTouched) {
  constexpr double kTouch = 1e-3;
  BenchBody body = make_bench_body({.exponent = 1.0});
  for (Element& element : body.element) {
    for (ElementNode& node : element.node) {
      node.touch_offset_m = kTouch;
    }
    element.node[2].samples = 0;
    element.node[2].touch_offset_m = -0.005;
  }
  FastState state = element_state(0.0);
  state.config.model = LocalModel::kEnergyTank;
  const auto at_depth = [&](double depth_m, bool update) {
    const Eigen::Vector3d x(0.52 * body.side_m(), 0.51 * body.side_m(), -depth_m);
    if (update) {
      send(state, body, x);
    }
    return step(state, {x, 0}, kTickS).force_n.z();
  };
  double deepest_n = 0.0;
  for (int n = -100; n <= 600; ++n) {
    deepest_n = at_depth(1e-5 * n, n % 20 == 0);
  }
  // It begins deeper by what could not be paid for at the first update in contact,
  // which comes 0.2 mm after the touch.
  const double slope = (deepest_n - at_depth(5e-3, false)) / 1e-3;
  const double begins_m = 6e-3 - deepest_n / slope;
  EXPECT_GE(begins_m, kTouch - 1e-9);
  EXPECT_LE(begins_m, kTouch + 2.1e-4);
  for (int n = 500; n >= 0; n -= 10) {
    const double depth = 1e-5 * n;
    EXPECT_NEAR(at_depth(depth, false), slope * std::max(0.0, depth - begins_m),
                1e-6 * deepest_n)
        << n;
  }
}

TEST(FastStep, ToolThatStartsInsideFeelsNothingUntilItMoves) {
  const BenchBody body = make_bench_body({.exponent = 2.0});
  FastState state = pressed(body, over_middle(body, 0.004));
  const FastCommand first = step(state, {over_middle(body, 0.004), 0}, kTickS);
  EXPECT_EQ(first.force_n.norm(), 0.0);
  EXPECT_NEAR(first.rest_offset_m, 0.004, 1e-9);
  const FastCommand deeper = step(state, {over_middle(body, 0.005), 0}, kTickS);
  EXPECT_GT(deeper.force_n.z(), 0.0);
  for (int n = 0; n < 100; ++n) {
    (void)step(state, {over_middle(body, 0.004 - 1e-4 * n), 0}, kTickS);
  }
  const FastCommand again = step(state, {over_middle(body, 0.004), 0}, kTickS);
  EXPECT_EQ(again.rest_offset_m, 0.0);
  EXPECT_NEAR(again.force_n.z(), body.element[0].node[0].curve().at(0.004).force_n,
              1e-12);
}

TEST(FastStep, StarvedToolIsReportedAndCarriesOn) {
  const BenchBody body = make_bench_body({.friction_min = 0.2, .friction_max = 0.2});
  FastState state = element_state(0.0);
  Eigen::Vector3d x = over_middle(body, -0.001);
  Element only = body.element[static_cast<std::size_t>(body.triangle_at(x))];
  only.active = true;
  accept(state, only);
  (void)step(state, {x, 0}, kTickS);
  x.z() = -0.003;
  (void)step(state, {x, 0}, kTickS);
  FastCommand command;
  for (int n = 0; n < 200; ++n) {
    x.x() += 1e-4;
    command = step(state, {x, 0}, kTickS);
  }
  EXPECT_TRUE(command.starved);
  EXPECT_EQ(contact(state).triangle, only.triangle);
  EXPECT_NEAR(command.force_n.z(), only.node[0].curve().at(0.003).force_n, 1e-9);
  EXPECT_NEAR(command.force_n.x(), -0.2 * command.force_n.z(), 1e-9);
  send(state, body, x);
  command = step(state, {x, 0}, kTickS);
  EXPECT_FALSE(command.starved);
  EXPECT_EQ(contact(state).triangle, body.triangle_at(x));
}

}  // namespace
}  // namespace palpate
