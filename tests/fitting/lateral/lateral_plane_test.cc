#include "fitting/lateral/lateral_plane.h"

#include <cmath>
#include <random>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

// A spring of 2000, 300, 1500 N/m that slides at 0.5 N, moved on a spiral, or on a
// line.
LateralRun plane_run(double noise_n, double size_m, bool on_line = false) {
  Eigen::Matrix2d K;
  K << 2000.0, 300.0, 300.0, 1500.0;
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  LateralRun run;
  run.normal_stated_n = 1.0;
  Eigen::Vector2d place = Eigen::Vector2d::Zero(), force = place;
  for (int i = 0; i < 900; ++i) {
    const double t = i / 900.0, grown = size_m * std::min(1.0, 3.0 * t);
    const Eigen::Vector2d next =
        on_line
            ? Eigen::Vector2d(0.6, 0.8) * size_m * std::sin(15.0 * t)
            : Eigen::Vector2d(grown * std::sin(13.0 * t), grown * std::sin(17.0 * t));
    for (int step = 0; step < 8; ++step) {
      force += K * (next - place) / 8.0;
      force *= std::min(1.0, 0.5 / std::max(force.norm(), 1e-12));
    }
    place = next;
    run.displacement_m.push_back(place[0]);
    run.across_m.push_back(place[1]);
    run.force_n.push_back(force[0] + 0.1 + noise_n * normal(generator));
    run.across_n.push_back(force[1] - 0.2 + noise_n * normal(generator));
  }
  return run;
}

void expect_within(const IntervalEstimate& e, double truth, double sd_most) {
  EXPECT_EQ(e.refused, "");
  EXPECT_NEAR(e.value, truth, 4.0 * e.sd);
  EXPECT_LT(e.sd, sd_most);
}

TEST(LateralPlane, TheTensorComesBackWithinItsErrors) {
  const PlaneFit fit = fit_plane(plane_run(0.005, 1e-3));
  EXPECT_EQ(fit.law, ContactLaw::kSharpSlip);
  EXPECT_GT(fit.deviance, 100.0);
  expect_within(fit.xx_n_per_m, 2000.0, 20.0);
  expect_within(fit.xy_n_per_m, 300.0, 20.0);
  expect_within(fit.yy_n_per_m, 1500.0, 20.0);
  expect_within(fit.friction, 0.5, 0.005);
  expect_within(fit.presliding_m, 0.5 / 1750.0, 0.01 * 0.5 / 1750.0);
}

TEST(LateralPlane, WithoutNoiseItIsExact) {
  const PlaneFit fit = fit_plane(plane_run(0.0, 1e-3));
  EXPECT_NEAR(fit.xx_n_per_m.value, 2000.0, 1e-3);
  EXPECT_NEAR(fit.xy_n_per_m.value, 300.0, 1e-3);
  EXPECT_NEAR(fit.friction.value, 0.5, 1e-6);
}

TEST(LateralPlane, WhatNeverSlidesHasATensorAndALowerBound) {
  const PlaneFit fit = fit_plane(plane_run(0.001, 0.1e-3));
  expect_within(fit.xx_n_per_m, 2000.0, 20.0);
  EXPECT_NE(fit.friction.refused, "");
  EXPECT_LT(fit.friction.above, 0.5);
  EXPECT_GT(fit.friction.above, 0.1);
}

// Along (0.6, 0.8) the displacement and the force are those along the line.
TEST(LateralPlane, AMotionOnALineIsARunAlongIt) {
  const LateralRun run = plane_run(0.0, 0.1e-3, true);
  const LineMotion line = along_line(run);
  ASSERT_TRUE(line.on_line);
  EXPECT_NEAR(line.direction_rad, std::atan2(0.8, 0.6), 1e-9);
  for (const std::size_t i : {100U, 500U}) {
    EXPECT_NEAR(line.run.displacement_m[i],
                0.6 * run.displacement_m[i] + 0.8 * run.across_m[i], 1e-15);
    EXPECT_NEAR(line.run.force_n[i], 0.6 * run.force_n[i] + 0.8 * run.across_n[i],
                1e-12);
  }
  EXPECT_FALSE(along_line(plane_run(0.0, 1e-3)).on_line);
}

TEST(LateralPlane, NeedsBothColumns) {
  LateralRun run = plane_run(0.0, 1e-3);
  run.across_n.pop_back();
  EXPECT_THROW((void)fit_plane(run), InputError);
}

}  // namespace
}  // namespace palpate
