#include "runtime/paper/slow_value_curve.h"

#include <gtest/gtest.h>

#include "tests/runtime/paper/power_law.h"

namespace palpate {
namespace {

TEST(LocalCurve, IsTheResponseWhereThatIsLinearQuadraticOrCubic) {
  for (const double p : {1.0, 2.0, 3.0}) {
    const LocalCurve curve = local_curve(power_law(100.0, p, 0.01));
    for (const double x : {0.001, 0.004, 0.008, 0.01}) {
      const SlowValue wanted = power_law(100.0, p, x);
      EXPECT_NEAR(at(curve, x).force_n, wanted.f_n, 1e-12) << p;
      EXPECT_NEAR(at(curve, x).energy_j, wanted.energy_j, 1e-14) << p;
      EXPECT_NEAR(at(curve, x).stiffness_n_per_m, wanted.k_n_per_m, 1e-9) << p;
    }
  }
}

TEST(LocalCurve, IsHertzsWithinAPercent) {
  const LocalCurve curve = local_curve(power_law(2000.0, 1.5, 0.01));
  for (double x = 0.0; x < 0.01; x += 1e-4) {
    EXPECT_NEAR(at(curve, x).force_n, power_law(2000.0, 1.5, x).f_n, 0.02) << x;
  }
}

TEST(LocalCurve, ForceIsTheSlopeOfTheEnergyEverywhere) {
  constexpr double kStepM = 1e-7;
  for (const double p : {0.7, 1.0, 1.5, 2.0, 3.0, 6.0}) {
    const SlowValue slow = power_law(100.0, p, 0.01);
    for (const double share : {1.0, 0.9, 0.5, 0.1, 1e-3, 0.0}) {
      LocalCurve curve = local_curve(slow);
      lower(curve, share * slow.energy_j);
      for (double x = -0.00203; x < 0.05; x += 1e-3) {
        const double slope =
            (at(curve, x + kStepM).energy_j - at(curve, x - kStepM).energy_j) /
            (2.0 * kStepM);
        EXPECT_NEAR(slope, at(curve, x).force_n, 1e-6 * slow.f_n + 1e-3 * kStepM)
            << p << " " << share << " " << x;
        EXPECT_GE(at(curve, x).force_n, 0.0);
      }
    }
  }
}

TEST(LocalCurve, LoweredHoldsWhatIsAllowedAndKeepsForceWhileItCan) {
  const SlowValue slow = power_law(100.0, 2.0, 0.01);
  const double tangent_j = slow.f_n * slow.f_n / (2.0 * slow.k_n_per_m);
  for (double share = 1.0; share >= 0.0; share -= 0.05) {
    LocalCurve curve = local_curve(slow);
    const double allowed_j = share * slow.energy_j;
    lower(curve, allowed_j);
    const CurvePoint point = at(curve, slow.x_m);
    EXPECT_LE(point.energy_j, allowed_j * (1.0 + 1e-12)) << share;
    EXPECT_GE(point.energy_j, allowed_j * (1.0 - 2e-9)) << share;
    if (allowed_j >= tangent_j) {
      EXPECT_NEAR(point.force_n, slow.f_n, 1e-12 * slow.f_n) << share;
    } else {
      EXPECT_LT(point.force_n, slow.f_n) << share;
      EXPECT_LT(point.stiffness_n_per_m, slow.k_n_per_m) << share;
    }
  }
}

// A plateau behind a steep start: the cubic would be steeper than thrice, so a line
// takes its place, as steep as it must be to store no more than the response does.
TEST(LocalCurve, OfAPlateauIsALineThatStoresTheSame) {
  for (const double force_n : {0.2, 0.5, 3.0}) {
    for (const double slope : {0.0, 1.0, 10.0}) {
      const SlowValue slow{0.005, force_n, slope, 0.95 * force_n * 0.004, 0.001};
      const LocalCurve curve = local_curve(slow);
      const CurvePoint end = at(curve, slow.x_m);
      EXPECT_NEAR(end.force_n, force_n, 1e-12);
      EXPECT_NEAR(end.energy_j, slow.energy_j, 1e-12 * slow.energy_j);
      EXPECT_NEAR(at(curve, 0.0049).force_n,
                  force_n - 1e-4 * force_n * force_n / (2.0 * slow.energy_j), 1e-12);
    }
  }
}

// delta_0 moves the curve deeper: what it says at x, it says at x + delta_0 afterwards.
TEST(LocalCurve, ShiftedSaysTheSameDeeper) {
  LocalCurve curve = local_curve(power_law(2000.0, 1.5, 0.01));
  const LocalCurve before = curve;
  curve.shift_m = 0.002;
  for (double x = 0.0; x < 0.014; x += 5e-4) {
    EXPECT_NEAR(at(curve, x + 0.002).force_n, at(before, x).force_n, 1e-13);
    EXPECT_NEAR(at(curve, x + 0.002).energy_j, at(before, x).energy_j, 1e-15);
  }
}

TEST(LocalCurve, NeverFallsAndIsNoSteeperThanThriceBeyondTheValue) {
  for (const double p : {0.3, 1.0, 3.0}) {
    const SlowValue slow = power_law(100.0, p, 0.01);
    const LocalCurve curve = local_curve(slow);
    double before = slow.f_n;
    for (double x = 0.0101; x < 0.1; x += 1e-4) {
      const CurvePoint point = at(curve, x);
      EXPECT_GE(point.force_n, before);
      EXPECT_LE(point.stiffness_n_per_m, 3.0 * slow.k_n_per_m * (1.0 + 1e-12));
      before = point.force_n;
    }
  }
}

}  // namespace
}  // namespace palpate
