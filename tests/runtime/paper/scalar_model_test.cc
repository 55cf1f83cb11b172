#include "runtime/paper/scalar_model.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/runtime/paper/power_law.h"
#include "tests/support/tick.h"

namespace palpate {
namespace {

ScalarModel make(LocalModel kind) {
  ScalarModel model;
  model.kind = kind;
  return model;
}

// The model and its account, moved along a response.
struct Rendering {
  ScalarModel model;
  PassivityLedger ledger;
  void tick(const SlowValue& value, bool slow = true) {
    advance(model, ledger, value.x_m, kTickS);
    if (slow) {
      update(model, ledger, value);
    }
  }
};

class EqualEnergyLimit : public testing::TestWithParam<double> {};

TEST_P(EqualEnergyLimit, RendersTwicePOverPPlusOneTimesTheResponse) {
  const double p = GetParam();
  Rendering r{make(LocalModel::kEqualEnergy), {}};
  constexpr int kUpdates = 100000;
  for (int i = 0; i <= kUpdates; ++i) {
    r.tick(power_law(1.0, p, 0.01 * i / kUpdates));
  }
  const double rendered = force_n(r.model, 0.01);
  const double factor = 2.0 * p / (p + 1.0);
  // First order in the number of updates.
  EXPECT_NEAR(rendered / power_law(1.0, p, 0.01).f_n, factor, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Exponents, EqualEnergyLimit,
                         testing::Values(1.0, 1.5, 2.0, 3.0));

TEST(EqualEnergy, UpdateKeepsTheEnergyExactly) {
  Rendering r{make(LocalModel::kEqualEnergy), {}};
  for (int i = 0; i < 50; ++i) {
    const SlowValue value = power_law(100.0, 2.0, 2e-4 * i);
    advance(r.model, r.ledger, value.x_m, kTickS);
    const double before_j = r.ledger.stored_j;
    update(r.model, r.ledger, value);
    EXPECT_NEAR(energy_j(r.model, value.x_m), before_j, 1e-18);
  }
  EXPECT_GT(r.ledger.stored_j, 0.0);
}

TEST(EqualEnergy, RelaxedStateIsThatOfEquation23) {
  Rendering r{make(LocalModel::kEqualEnergy), {}};
  for (int i = 0; i < 30; ++i) {
    r.tick(power_law(100.0, 2.0, 2e-4 * i));
  }
  const double k_before = r.model.k_n_per_m;
  const double c_before = r.model.c_m;
  const double x = 2e-4 * 30;
  r.tick(power_law(100.0, 2.0, x));
  const double root = std::sqrt(k_before / r.model.k_n_per_m);
  EXPECT_NEAR(r.model.c_m, (1.0 - root) * x + root * c_before, 1e-15);
}

TEST(EqualEnergy, StaysWhereTheToolDidNotMoveOrTheForceFell) {
  Rendering r{make(LocalModel::kEqualEnergy), {}};
  for (int i = 0; i < 20; ++i) {
    r.tick(power_law(100.0, 2.0, 2e-4 * i));
  }
  const ScalarModel before = r.model;
  const SlowValue same = before.latest;
  r.tick(same);
  EXPECT_DOUBLE_EQ(r.model.k_n_per_m, before.k_n_per_m);
  EXPECT_NEAR(r.model.c_m, before.c_m, 1e-15);
  SlowValue falling = same;
  falling.x_m += 1e-4;
  falling.f_n -= 1e-4;
  r.tick(falling);
  EXPECT_DOUBLE_EQ(r.model.k_n_per_m, before.k_n_per_m);
  EXPECT_NEAR(r.model.c_m, before.c_m, 1e-15);
}

// A secant of two responses, the tool having moved sideways from a soft place to a
// stiff one.
TEST(EqualEnergy, IsNoStifferThanTheResponsesAre) {
  Rendering r{make(LocalModel::kEqualEnergy), {}};
  for (int i = 0; i < 20; ++i) {
    r.tick(power_law(100.0, 1.0, 2e-4 * i));
  }
  SlowValue stiff = power_law(300.0, 1.0, r.model.latest.x_m + 1e-5);
  r.tick(stiff);
  EXPECT_DOUBLE_EQ(r.model.k_n_per_m, 300.0);
  EXPECT_NEAR(imbalance_j(r.ledger), 0.0, 1e-18);
}

TEST(EqualEnergy, FreeSpaceKeepsTheModelUntilItsEnergyIsGone) {
  Rendering r{make(LocalModel::kEqualEnergy), {}};
  for (int i = 0; i < 20; ++i) {
    r.tick(power_law(100.0, 2.0, 2e-4 * i));
  }
  const double k = r.model.k_n_per_m;
  const double c = r.model.c_m;
  const double held = 0.5 * (c + r.model.latest.x_m);
  advance(r.model, r.ledger, held, kTickS);
  update(r.model, r.ledger, {held, 0.0, 0.0, 0.0});  // (24), E > 0
  EXPECT_DOUBLE_EQ(r.model.k_n_per_m, k);
  EXPECT_NEAR(r.model.c_m, c, 1e-15);
  advance(r.model, r.ledger, -0.001, kTickS);
  update(r.model, r.ledger, {-0.001, 0.0, 0.0, 0.0});  // (24), E = 0
  EXPECT_EQ(r.model.k_n_per_m, 0.0);
  EXPECT_EQ(r.model.c_m, -0.001);
}

TEST(EnergyTank, HasForceAndSlopeWhereTheTankCanPay) {
  Rendering r{make(LocalModel::kEnergyTank), {}};
  for (int i = 0; i <= 100; ++i) {
    r.tick(power_law(1000.0, 2.0, 1e-4 * i));
  }
  const SlowValue value = power_law(1000.0, 2.0, 0.01);
  EXPECT_NEAR(force_n(r.model, 0.01), value.f_n, 1e-12);
  EXPECT_NEAR(at(r.model.curve, 0.01).stiffness_n_per_m, value.k_n_per_m, 1e-9);
  // Between what the tangent needs and what the curve stores.
  EXPECT_GE(r.ledger.stored_j, value.f_n * value.f_n / (2.0 * value.k_n_per_m));
  EXPECT_LE(r.ledger.stored_j, value.energy_j);
  EXPECT_GE(r.ledger.tank_j, 0.0);
}

TEST(EnergyTank, PlateauStoresNoMoreThanTheCurve) {
  Rendering r{make(LocalModel::kEnergyTank), {}};
  for (int i = 0; i <= 100; ++i) {
    r.tick(power_law(100.0, 1.0, 1e-4 * i));
  }
  const double e = r.ledger.stored_j;
  // The force stays 1 N from here: slope 0.
  const SlowValue plateau{0.0101, 1.0, 0.0, 0.005 + 1e-4};
  r.tick(plateau);
  EXPECT_LE(r.ledger.stored_j, plateau.energy_j * (1.0 + 1e-12));
  EXPECT_GT(r.ledger.stored_j, e);
  EXPECT_NEAR(force_n(r.model, plateau.x_m), 1.0, 0.02);
}

TEST(EnergyTank, NeverHoldsMoreThanWasPaidIn) {
  Rendering r{make(LocalModel::kEnergyTank), {}};
  r.tick(power_law(1000.0, 2.0, 0.01));  // appears inside the wall
  EXPECT_EQ(force_n(r.model, 0.01), 0.0);
  EXPECT_EQ(r.ledger.stored_j, 0.0);
  r.tick(power_law(1000.0, 2.0, 0.011));
  EXPECT_GT(force_n(r.model, 0.011), 0.0);
  EXPECT_LT(force_n(r.model, 0.011), power_law(1000.0, 2.0, 0.011).f_n);
  EXPECT_NEAR(imbalance_j(r.ledger), 0.0, 1e-18);
}

TEST(EnergyTank, FreeSpaceEmptiesTheTank) {
  Rendering r{make(LocalModel::kEnergyTank), {}};
  for (int i = 0; i <= 100; ++i) {
    r.tick(power_law(1000.0, 3.0, 1e-4 * i));
  }
  r.tick(power_law(500.0, 3.0, 0.01));  // a softer place frees energy
  EXPECT_GT(r.ledger.tank_j, 0.0);
  r.tick({-0.001, 0.0, 0.0, 0.0});
  EXPECT_EQ(r.ledger.tank_j, 0.0);
  EXPECT_EQ(r.ledger.stored_j, 0.0);
  EXPECT_NEAR(r.ledger.work_j, r.ledger.dissipated_j, 1e-18);
}

TEST(FirstOrderHold, ExtrapolatesOneIntervalAndDoesNotPull) {
  Rendering r{make(LocalModel::kFirstOrderHold), {}};
  r.tick({0.001, 1.0, 0.0, 0.0});
  for (int n = 0; n < 20; ++n) {
    r.tick({0.002, 3.0, 0.0, 0.0}, n == 19);
  }
  EXPECT_DOUBLE_EQ(force_n(r.model, 0.0), 3.0);
  for (int n = 0; n < 10; ++n) {
    r.tick({0.002, 0.0, 0.0, 0.0}, false);
  }
  EXPECT_NEAR(force_n(r.model, 0.0), 4.0, 1e-12);
  for (int n = 0; n < 100; ++n) {
    r.tick({0.002, 0.0, 0.0, 0.0}, false);
  }
  EXPECT_NEAR(force_n(r.model, 0.0), 5.0, 1e-12);
  r.tick({0.0, 0.0, 0.0, 0.0});
  r.tick({0.0, 0.0, 0.0, 0.0}, false);
  EXPECT_EQ(force_n(r.model, 0.0), 0.0);
}

TEST(Single, HoldsTheSlowForce) {
  Rendering r{make(LocalModel::kSingle), {}};
  r.tick({0.001, 1.5, 0.0, 0.0});
  r.tick({0.009, 0.0, 0.0, 0.0}, false);
  EXPECT_EQ(force_n(r.model, 0.009), 1.5);
  EXPECT_NEAR(energy_j(r.model, 0.009) - energy_j(r.model, 0.001), 1.5 * 0.008, 1e-15);
}

}  // namespace
}  // namespace palpate
