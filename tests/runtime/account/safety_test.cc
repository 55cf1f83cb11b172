#include "runtime/account/safety.h"

#include <limits>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr double kMillisecondS = 0.001;
constexpr double kInf = std::numeric_limits<double>::infinity();
const Eigen::Vector3d kStill = Eigen::Vector3d::Zero();

TEST(Safety, ClampsTheWholeVectorAndKeepsItsDirection) {
  SafetyState state;
  const Eigen::Vector3d wanted(3.0, -6.0, 6.0);
  const Eigen::Vector3d f =
      make_safe(state, {.force_max_n = 3.0, .slew_max_n_per_s = kInf}, {}, wanted,
                kStill, kMillisecondS);
  EXPECT_NEAR(f.norm(), 3.0, 1e-12);
  EXPECT_NEAR(f.cross(wanted).norm(), 0.0, 1e-12);
}

TEST(Safety, ClampsTheChangeOfForce) {
  SafetyState state;
  const SafetyLimits limits{.force_max_n = 10.0, .slew_max_n_per_s = 1000.0};
  for (int n = 1; n <= 5; ++n) {
    const Eigen::Vector3d f =
        make_safe(state, limits, {}, {0.0, 0.0, 4.5}, kStill, kMillisecondS);
    EXPECT_NEAR(f.z(), std::min(4.5, n * 1.0), 1e-12);
  }
}

TEST(Safety, NotFiniteForceIsZeroAndLatched) {
  SafetyState state;
  const SafetyLimits limits;
  const Eigen::Vector3d good(0.0, 0.0, 1.0);
  (void)make_safe(state, limits, {}, good, kStill, kMillisecondS);
  EXPECT_EQ(
      make_safe(state, limits, {}, {0.0, kInf, 0.0}, kStill, kMillisecondS).norm(),
      0.0);
  EXPECT_EQ(state.fault, Fault::kNotFinite);
  EXPECT_EQ(make_safe(state, limits, {}, good, kStill, kMillisecondS).norm(), 0.0);
}

TEST(Safety, AnAccountThatDoesNotCloseIsAnEnergyFault) {
  SafetyState state;
  const PassivityLedger ledger{.work_j = 0.0, .stored_j = 1e-6};
  const Eigen::Vector3d f =
      make_safe(state, {}, ledger, {0.0, 0.0, 1.0}, kStill, kMillisecondS);
  EXPECT_EQ(state.fault, Fault::kEnergy);
  EXPECT_EQ(f.norm(), 0.0);
}

TEST(Safety, EnergyThatASlewLagCreatesIsAFault) {
  // The force follows a withdrawal late and pushes where the model has let go.
  SafetyState state;
  const SafetyLimits limits{.force_max_n = 10.0, .slew_max_n_per_s = 1e4};
  (void)make_safe(state, limits, {}, {0.0, 0.0, 8.0}, kStill, kMillisecondS);
  const SafetyLimits slow{.force_max_n = 10.0, .slew_max_n_per_s = 1.0};
  int ticks = 0;
  for (; ticks < 100 && state.fault == Fault::kNone; ++ticks) {
    (void)make_safe(state, slow, {}, kStill, {0.0, 0.0, 1e-4}, kMillisecondS);
  }
  EXPECT_EQ(state.fault, Fault::kEnergy);
  // 8 N over 0.1 mm a tick pass the floor of 10 mJ in the 13th movement after it.
  EXPECT_NEAR(ticks, 14, 1);
}

TEST(Safety, WhatTheClampsTookIsNotLent) {
  // A glitch of the sensor: deep inside for one tick, at a force that is clamped, and
  // out again. The user lost energy on the way out, which pays for nothing later.
  SafetyState state;
  const SafetyLimits limits{.force_max_n = 1.0, .slew_max_n_per_s = kInf};
  (void)make_safe(state, limits, {}, {0.0, 0.0, 400.0}, {0.0, 0.0, -1.0},
                  kMillisecondS);
  (void)make_safe(state, limits, {}, kStill, {0.0, 0.0, 1.0}, kMillisecondS);
  EXPECT_EQ(state.owed_j, 0.0);
  EXPECT_EQ(state.fault, Fault::kNone);
}

TEST(Safety, ClampThatHoldsWhilePressingAndReleasingGainsNothing) {
  SafetyState state;
  const SafetyLimits limits{.force_max_n = 1.0, .slew_max_n_per_s = kInf};
  double largest = 0.0;
  for (const double way : {-1e-4, 1e-4}) {
    for (int n = 0; n < 50; ++n) {  // 3 N of the model, 5 mm in, 5 mm out
      (void)make_safe(state, limits, {}, {0.0, 0.0, 3.0}, {0.0, 0.0, way},
                      kMillisecondS);
      largest = std::max(largest, state.owed_j);
    }
  }
  EXPECT_NEAR(largest, 2.0 * 49e-4, 1e-12);  // below the floor of 10 mJ
  EXPECT_EQ(state.fault, Fault::kNone);
  EXPECT_LE(state.owed_j, 1e-12);
}

TEST(Safety, RampRaisesTheClampFromZeroInProportionToTime) {
  SafetyState state;
  const SafetyLimits limits{
      .force_max_n = 4.0, .slew_max_n_per_s = kInf, .ramp_s = 0.01};
  for (int n = 1; n <= 20; ++n) {
    const Eigen::Vector3d f =
        make_safe(state, limits, {}, {0.0, 0.0, 3.0}, kStill, kMillisecondS);
    EXPECT_NEAR(f.z(), std::min(3.0, 0.4 * n), 1e-12) << n;
  }
}

TEST(Safety, FirstFaultStays) {
  SafetyState state;
  raise_fault(state, Fault::kDeadlines);
  raise_fault(state, Fault::kNotFinite);
  EXPECT_EQ(state.fault, Fault::kDeadlines);
  EXPECT_EQ(name(state.fault), "deadlines");
  EXPECT_EQ(name(Fault::kDeviceSilent), "device-silent");
  EXPECT_EQ(name(Fault{200}), "unknown");
}

TEST(PassivityLedger, EveryChangeKeepsTheIdentity) {
  PassivityLedger ledger;
  book_work(ledger, 3.0);         // the user presses
  book_change(ledger, 1.0, 1.5);  // frees 2: 1.5 kept, 0.5 lost
  EXPECT_DOUBLE_EQ(ledger.tank_j, 1.5);
  EXPECT_DOUBLE_EQ(ledger.dissipated_j, 0.5);
  book_change(ledger, 2.0, 1.5);  // costs 1
  EXPECT_DOUBLE_EQ(ledger.tank_j, 0.5);
  book_work(ledger, 0.0);  // the user withdraws
  EXPECT_DOUBLE_EQ(ledger.work_j, 1.0);
  EXPECT_DOUBLE_EQ(imbalance_j(ledger), 0.0);
}

TEST(PassivityLedger, ShortfallsAreCountedAndAddedUp) {
  PassivityLedger ledger{.stored_j = 1.0, .tank_j = 0.5};
  note_shortfall(ledger, 1.5);  // all of it is there
  EXPECT_EQ(ledger.interventions, 0U);
  note_shortfall(ledger, 3.5);
  note_shortfall(ledger, 2.0);
  EXPECT_EQ(ledger.interventions, 2U);
  EXPECT_DOUBLE_EQ(ledger.cut_j, 2.5);
}

TEST(PassivityLedger, WhatIsNotPaidIsSeen) {
  PassivityLedger ledger;
  book_change(ledger, 1.0, 0.0);
  EXPECT_DOUBLE_EQ(ledger.created_j, 1.0);
  EXPECT_DOUBLE_EQ(imbalance_j(ledger), -1.0);
}

}  // namespace
}  // namespace palpate
