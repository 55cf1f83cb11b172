// A spring that is rendered late, moved by a given motion: everything in closed form.
#include "tests/bench/runtime/wire_energy.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr double kStiffness = 200.0;  // [N/m]
constexpr double kSpeed = 40.0;       // [rad/s] of the motion
constexpr double kSway = 0.002;       // [m]
constexpr double kTick = 1e-3;        // [s]

// Pressed in by kSway (1 - cos wt), force held for a tick, `lag` ticks old.
std::vector<MotorRecord> rendered(int lag, double gain, int ticks) {
  constexpr int kFine = 50;  // steps in a tick
  const auto depth = [](double time_s) {
    return kSway * (1.0 - std::cos(kSpeed * std::max(0.0, time_s)));
  };
  std::vector<MotorRecord> trace;
  MotorRecord now;
  for (int i = 0; i < ticks; ++i) {
    const double time_s = i * kTick;
    now.time_ns = std::llround(time_s * 1e9);
    now.force_n = gain * kStiffness * depth(time_s - lag * kTick);
    trace.push_back(now);
    for (int k = 0; k < kFine; ++k) {
      const double step_s = kTick / kFine;
      const double from_s = time_s + k * step_s;
      const double moved_m = depth(from_s + step_s) - depth(from_s);
      now.work_j -= now.force_n * moved_m;
      now.path_m += std::abs(moved_m);
      now.squared_speed_m2_per_s += moved_m * moved_m / step_s;
    }
  }
  return trace;
}

// One round of K a sin wt dt . v, late by lag and half a tick:
// K a^2 pi w (lag + 1/2) T of energy.
TEST(WireEnergy, OfALateSpringIsTheClosedFormAndKeepsTheBound) {
  const double round_s = 2.0 * std::numbers::pi / kSpeed;
  const int ticks = static_cast<int>(20.0 * round_s / kTick);
  for (const int lag : {0, 1, 2, 4}) {
    const auto trace = rendered(lag, 1.0, ticks);
    const WireEnergy energy = wire_energy(trace, kStiffness, (lag + 1) * kTick, 0.0);
    const double expected_j = 20.0 * kStiffness * kSway * kSway * std::numbers::pi *
                              kSpeed * (lag + 0.5) * kTick;
    EXPECT_NEAR(energy.given_end_j, expected_j, 0.05 * expected_j) << lag;
    EXPECT_GE(energy.margin_min_j, 0.0) << lag;
    EXPECT_LT(energy.bound_end_j, 2.2 * expected_j + 1e-3) << lag;
  }
}

TEST(WireEnergy, BeyondWhatTheDelayExplainsIsFound) {
  const auto trace = rendered(8, 1.0, 3000);
  EXPECT_LT(wire_energy(trace, kStiffness, 2e-3, 0.0).margin_min_j, 0.0);
  EXPECT_GE(wire_energy(trace, kStiffness, 9e-3, 0.0).margin_min_j, 0.0);
}

TEST(WireEnergy, FreeMotionAddsNothingToTheBound) {
  const auto trace = rendered(2, 0.0, 3000);
  const WireEnergy energy = wire_energy(trace, kStiffness, 3e-3, 5e-5);
  EXPECT_EQ(energy.bound_end_j, 0.0);
  EXPECT_EQ(energy.given_max_j, 0.0);
  EXPECT_EQ(wire_energy({}, kStiffness, 3e-3, 0.0).margin_min_j, 0.0);
}

}  // namespace
}  // namespace palpate
