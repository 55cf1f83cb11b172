#include "fitting/lateral/friction_history.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/fitting/lateral/loop_simulation.h"

namespace palpate {
namespace {

ContactCurve history_curve(bool partial_slip) {
  return {partial_slip ? ContactLaw::kPartialSlip : ContactLaw::kSharpSlip, 2000.0,
          0.5};
}

TEST(FrictionHistory, UnloadingIsTheCurveAtTwiceItsScale) {
  for (const bool partial_slip : {false, true}) {
    const ContactCurve curve = history_curve(partial_slip);
    FrictionHistory history(curve, 0.0);
    const double top = history.move_to(0.2e-3).share;
    EXPECT_DOUBLE_EQ(top, force_share(curve, 0.2e-3).value);
    EXPECT_DOUBLE_EQ(history.move_to(0.1e-3).share,
                     top - 2.0 * force_share(curve, 0.05e-3).value);
    // Beyond the mirror image of the turn it is the curve from rest again.
    EXPECT_DOUBLE_EQ(history.move_to(-0.3e-3).share, -force_share(curve, 0.3e-3).value);
  }
}

TEST(FrictionHistory, ASmallLoopIsForgotten) {
  FrictionHistory with(history_curve(true), 0.0), without(history_curve(true), 0.0);
  for (const double x : {0.2e-3, -0.1e-3, 0.05e-3, -0.05e-3, 0.05e-3}) {
    (void)with.move_to(x);
  }
  EXPECT_NEAR(with.move_to(0.3e-3).share, without.move_to(0.3e-3).share, 1e-14);
}

// Springs in parallel: one exactly; of 200 each bin may be off by its weight times its
// width, 1.5 * 2 / 200^2 = 7.5e-5, at each of a few fronts.
TEST(FrictionHistory, FollowsSpringsInParallelOnAnyPath) {
  for (const bool partial_slip : {false, true}) {
    std::mt19937 generator(1);
    std::normal_distribution<double> normal;
    SimulatedContact contact;
    contact.partial_slip = partial_slip;
    SimulatedSprings springs(contact);
    FrictionHistory history(history_curve(partial_slip), 0.0);
    double x = 0.0, worst = 0.0;
    for (int i = 0; i < 3000; ++i) {
      const double step = 0.1e-3 * normal(generator);
      x += step;
      springs.step(step);
      worst = std::max(worst, std::abs(history.move_to(x).share -
                                       springs.force_after(0.0) / contact.slip_n()));
    }
    EXPECT_LT(worst, partial_slip ? 5e-4 : 1e-12);
  }
}

TEST(FrictionHistory, DerivativesFollowThePath) {
  const double step = 1e-6;
  const auto end_of_path = [](double by_k, double by_slip, double zero_m) {
    ContactCurve curve = history_curve(true);
    curve.stiffness_n_per_m *= std::exp(by_k);
    curve.slip_force_n *= std::exp(by_slip);
    FrictionHistory history(curve, zero_m);
    FrictionState state;
    for (const double x : {0.2e-3, 0.05e-3, 0.12e-3}) {
      state = history.move_to(x);
    }
    return state;
  };
  const FrictionState state = end_of_path(0.0, 0.0, 0.0);
  EXPECT_NEAR(
      (end_of_path(step, 0, 0).share - end_of_path(-step, 0, 0).share) / (2.0 * step),
      state.by_log_k, 1e-8);
  EXPECT_NEAR(
      (end_of_path(0, step, 0).share - end_of_path(0, -step, 0).share) / (2.0 * step),
      state.by_log_slip, 1e-8);
  EXPECT_NEAR(
      (end_of_path(0, 0, 1e-10).share - end_of_path(0, 0, -1e-10).share) / 2e-10,
      state.by_zero, 1e-3);
}

TEST(FrictionHistory, SaysWhereTheMotionBeganAndWhetherAllSlides) {
  FrictionHistory history(history_curve(false), 1e-3);
  EXPECT_TRUE(history.move_to(1.1e-3).from_rest);
  EXPECT_NEAR(history.move_to(1.1e-3).stick_share, 0.4, 1e-12);
  EXPECT_GT(history.move_to(2e-3).stick_share, 1.0);
  const FrictionState back = history.move_to(1.75e-3);
  EXPECT_FALSE(back.from_rest);
  EXPECT_DOUBLE_EQ(back.from_m, 2e-3);
  EXPECT_NEAR(back.stick_share, 0.5, 1e-12);
}

}  // namespace
}  // namespace palpate
