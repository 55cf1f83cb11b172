#include "runtime/fast/element_model.h"

#include <algorithm>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "runtime/bench/bench_body.h"

namespace palpate {
namespace {

constexpr double kModelTickS = 0.001;
constexpr double kModelFriction = 0.5;
const Vector3 kOverFirst(0.004, 0.003, 0.0);

BenchBodyOptions rough_squares(double friction = kModelFriction) {
  BenchBodyOptions options;
  options.cells = 2;
  options.cell_m = 0.01;
  options.friction_min = friction;
  options.friction_max = friction;
  return options;
}

// A tool without size over elements that are all at hand.
struct AdvancedModel {
  explicit AdvancedModel(const BenchBodyOptions& options)
      : body(make_bench_body(options)),
        cache(std::make_unique<ElementCache>()),
        memory(std::make_unique<SurfaceMemory>()) {
    send(1.0, kOverFirst);
  }

  // All elements, forces times a factor, the one at x active.
  void send(double factor, const Vector3& x_m) {
    for (Element element : body.element) {
      element.active = element.triangle == body.triangle_at(x_m);
      for (ElementNode& node : element.node) {
        for (auto* values : {&node.force_n, &node.stiffness_n_per_m, &node.energy_j}) {
          for (double& value : *values) {
            value *= factor;
          }
        }
      }
      EXPECT_TRUE(store(*cache, element));
    }
  }

  ElementResponse tick(const Vector3& x_m, double dt_s = kModelTickS) {
    return advance(model, *cache, *memory, ledger, limits, x_m, dt_s);
  }

  // Straight down to a depth, so slowly that nothing is cut.
  ElementResponse press(double depth_m) {
    ElementResponse response;
    for (int n = 0; n <= 10; ++n) {
      response = tick(kOverFirst - Vector3(0.0, 0.0, 0.1 * n * depth_m));
    }
    return response;
  }

  // As if changes before had freed so much.
  void grant(double tank_j) {
    ledger.tank_j += tank_j;
    ledger.work_j += tank_j;
  }

  void expect_closed() const {
    EXPECT_NEAR(imbalance_j(ledger), 0.0, 1e-15);
    EXPECT_GE(ledger.tank_j, 0.0);
    EXPECT_GE(ledger.dissipated_j, 0.0);
    EXPECT_NEAR(ledger.created_j, 0.0, 1e-15);
  }

  BenchBody body;
  std::unique_ptr<ElementCache> cache;
  std::unique_ptr<SurfaceMemory> memory;
  ElementModel model;
  PassivityLedger ledger;
  ElementModelLimits limits;
};

TEST(ElementModel, WithoutAnElementNothingIsRenderedOrBooked) {
  AdvancedModel rendered(rough_squares());
  *rendered.cache = ElementCache{};
  const ElementResponse response = rendered.tick({0.004, 0.003, -0.002});
  EXPECT_EQ(response.potential_j(), 0.0);
  EXPECT_EQ(rendered.ledger.work_j, 0.0);
  EXPECT_EQ(rendered.model.slot, -1);
}

TEST(ElementModel, PressingIsTheCurveAndItsEnergyTheWork) {
  AdvancedModel rendered(rough_squares());
  const ElementResponse response = rendered.press(0.002);
  const auto at = rendered.body.element[0].node[0].curve().at(0.002);
  EXPECT_NEAR(response.normal_n / at.force_n, 1.0, 1e-12);
  EXPECT_NEAR(rendered.ledger.work_j / at.energy_j, 1.0, 1e-12);
  EXPECT_NEAR(rendered.ledger.stored_j / at.energy_j, 1.0, 1e-12);
  EXPECT_EQ(rendered.ledger.interventions, 0U);
  EXPECT_EQ(rendered.model.shift_m, 0.0);
  rendered.expect_closed();
}

TEST(ElementModel, AStifferCopyHoldsNoMoreThanTheOldOneDid) {
  AdvancedModel rendered(rough_squares());
  const ElementResponse before = rendered.press(0.002);
  rendered.send(3.0, kOverFirst);
  const ElementResponse after = rendered.tick({0.004, 0.003, -0.002});
  EXPECT_LE(after.potential_j(), before.potential_j());
  EXPECT_NEAR(after.potential_j() / before.potential_j(), 1.0, 2e-9);
  EXPECT_GT(rendered.model.shift_m, 1e-4);
  EXPECT_EQ(rendered.ledger.interventions, 1U);
  rendered.expect_closed();
}

TEST(ElementModel, WhatWasFreedPaysForAStifferCopy) {
  AdvancedModel rendered(rough_squares());
  const ElementResponse before = rendered.press(0.002);
  rendered.grant(1.0);
  rendered.send(3.0, kOverFirst);
  const ElementResponse after = rendered.tick({0.004, 0.003, -0.002});
  EXPECT_NEAR(after.normal_j / before.normal_j, 3.0, 1e-12);
  EXPECT_EQ(rendered.model.shift_m, 0.0);
  EXPECT_EQ(rendered.ledger.interventions, 0U);
  // The tank keeps what the curves could store here, no more.
  EXPECT_LE(rendered.ledger.tank_j, after.normal_j * (1.0 + 1e-12));
  rendered.expect_closed();
}

// Stiffness comes back by as much as time permits, and the account pays.
TEST(ElementModel, TheShiftIsBledBackAtItsRateWhereThatIsPaidFor) {
  AdvancedModel rendered(rough_squares());
  (void)rendered.press(0.002);
  rendered.send(3.0, kOverFirst);
  const Vector3 x(0.004, 0.003, -0.002);
  (void)rendered.tick(x);
  const double shift_m = rendered.model.shift_m;
  const double work_j = rendered.ledger.work_j;
  (void)rendered.tick(x);
  // Nothing is left to pay with: 1e-9 of the energy.
  EXPECT_NEAR(rendered.model.shift_m, shift_m, 1e-10);
  rendered.grant(1.0);
  for (const double dt_s : {kModelTickS, 0.5 * kModelTickS}) {
    const double before_m = rendered.model.shift_m;
    (void)rendered.tick(x, dt_s);
    EXPECT_NEAR(before_m - rendered.model.shift_m,
                rendered.limits.recovery_m_per_s * dt_s, 1e-10);
  }
  EXPECT_NEAR(rendered.ledger.work_j, work_j + 1.0, 1e-15);
  rendered.expect_closed();
}

TEST(ElementModel, WithoutLoadTheShiftSinksToTheToolAndNoFarther) {
  AdvancedModel rendered(rough_squares());
  (void)rendered.press(0.002);
  rendered.send(3.0, kOverFirst);
  (void)rendered.tick({0.004, 0.003, -0.002});
  ASSERT_GT(rendered.model.shift_m, 5e-4);
  const ElementResponse above = rendered.tick({0.004, 0.003, -3e-4});
  EXPECT_FALSE(above.loaded);
  EXPECT_NEAR(rendered.model.shift_m, 3e-4, 1e-15);
  (void)rendered.tick({0.004, 0.003, 1e-3});
  EXPECT_EQ(rendered.model.shift_m, 0.0);
  rendered.expect_closed();
}

TEST(ElementModel, SticksByASpringThatSlidesAtCoulombsForce) {
  AdvancedModel rendered(rough_squares());
  const double normal_n = rendered.press(0.002).normal_n;
  const double presliding_m = rendered.model.presliding_m;
  const Vector3 x(0.004, 0.003, -0.002);
  const auto force_at = [&](double side_m) {
    const ElementResponse response = rendered.tick(x + Vector3(side_m, 0.0, 0.0));
    return force_n(rendered.model, response);
  };
  const double coulomb_n = kModelFriction * normal_n;
  EXPECT_NEAR(force_at(0.4 * presliding_m).x(), -0.4 * coulomb_n, 1e-9);
  EXPECT_NEAR(force_at(0.9 * presliding_m).x(), -0.9 * coulomb_n, 1e-9);
  EXPECT_NEAR(force_at(0.4 * presliding_m).x(), -0.4 * coulomb_n, 1e-9);
  EXPECT_EQ(rendered.ledger.dissipated_j, 0.0);
  EXPECT_NEAR(force_at(1.5 * presliding_m).x(), -coulomb_n, 1e-9);
  EXPECT_NEAR(force_at(3.0 * presliding_m).x(), -coulomb_n, 1e-9);
  // Back by the presliding: the spring is where it rests.
  EXPECT_NEAR(force_at(2.0 * presliding_m).x(), 0.0, 1e-9);
  // From 1.5 and from 2.5 preslidings to one: k_t (1.25 + 5.25) delta_L^2 / 2.
  EXPECT_NEAR((rendered.ledger.dissipated_j + rendered.ledger.tank_j) /
                  (3.25 * coulomb_n * presliding_m),
              1.0, 1e-9);
  rendered.expect_closed();
}

TEST(ElementModel, WithoutFrictionTheContactFollowsAndNothingIsLost) {
  AdvancedModel rendered(rough_squares(0.0));
  (void)rendered.press(0.002);
  for (int n = 1; n <= 30; ++n) {
    const Vector3 x(0.004 + 1e-4 * n, 0.003, -0.002);
    const ElementResponse response = rendered.tick(x);
    ASSERT_NEAR(force_n(rendered.model, response).head<2>().norm(), 0.0, 1e-9) << n;
    ASSERT_NEAR(rendered.model.anchor_m.x(), x.x(), 1e-12) << n;
  }
  EXPECT_NEAR(rendered.ledger.dissipated_j, 0.0, 1e-15);
  rendered.expect_closed();
}

TEST(ElementModel, AnotherActiveElementIsTakenInFreeAirAlone) {
  AdvancedModel rendered(rough_squares());
  (void)rendered.press(0.002);
  const std::int32_t first = triangle_in(*rendered.cache, rendered.model.slot);
  const Vector3 far(0.014, 0.017, -0.002);
  ASSERT_NE(rendered.body.triangle_at(far), first);
  rendered.send(1.0, far);
  (void)rendered.tick({0.004, 0.003, -0.002});
  EXPECT_EQ(triangle_in(*rendered.cache, rendered.model.slot), first);
  (void)rendered.tick({0.014, 0.017, 0.001});
  rendered.send(1.0, far);
  (void)rendered.tick({0.014, 0.017, 0.001});
  EXPECT_EQ(triangle_in(*rendered.cache, rendered.model.slot),
            rendered.body.triangle_at(far));
  rendered.expect_closed();
}

// Whatever comes and wherever the tool goes, nobody gets more than was put in.
TEST(ElementModel, RandomMovesAmongRandomCopiesStayPassive) {
  AdvancedModel rendered(rough_squares());
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Vector3 x(0.01, 0.01, 0.001);
  for (int n = 0; n < 3000; ++n) {
    if (n % 7 == 0) {
      rendered.send(0.2 + 5.0 * unit(random), x);
    }
    x += 3e-4 *
         (Vector3(unit(random), unit(random), unit(random)).array() - 0.5).matrix();
    x = x.cwiseMax(Vector3(0.001, 0.001, -0.005))
            .cwiseMin(Vector3(0.019, 0.019, 0.001));
    const double most_j = allowance_j(rendered.ledger);
    const double work_j = rendered.ledger.work_j;
    const ElementResponse response = rendered.tick(x);
    const double worked_j = rendered.ledger.work_j - work_j;
    ASSERT_LE(response.potential_j(), most_j + worked_j + 1e-15) << n;
    ASSERT_GE(rendered.ledger.work_j, -1e-15) << n;
    ASSERT_NEAR(rendered.ledger.stored_j, response.potential_j(), 1e-15) << n;
    ASSERT_GE(rendered.model.shift_m, 0.0) << n;
  }
  EXPECT_GT(rendered.ledger.interventions, 50U);
  EXPECT_NEAR(imbalance_j(rendered.ledger), 0.0, 1e-13);
  EXPECT_NEAR(rendered.ledger.created_j, 0.0, 1e-13);
}

}  // namespace
}  // namespace palpate
