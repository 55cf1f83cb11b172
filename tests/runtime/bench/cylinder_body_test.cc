// The paper's cylinder: a closed, valid body whose curve is (31) without its misprints.
#include "runtime/bench/cylinder_body.h"

#include <numbers>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(CylinderBody, TheResponseAndItsSlopeAreContinuous) {
  const double k = 170.0;
  const double bend = 0.005;
  const double h = 1e-9;
  EXPECT_EQ(cylinder_force_n(k, -0.001), 0.0);
  EXPECT_NEAR(cylinder_force_n(k, bend - h), cylinder_force_n(k, bend + h),
              3.0 * k * h);
  const double below = (cylinder_force_n(k, bend) - cylinder_force_n(k, bend - h)) / h;
  const double above = (cylinder_force_n(k, bend + h) - cylinder_force_n(k, bend)) / h;
  EXPECT_NEAR(below, k, 1e-4 * k);  // differences of numbers that agree to 1e-7
  EXPECT_NEAR(above, k, 1e-4 * k);
}

TEST(CylinderBody, IsAClosedBodyThatADatabaseMayHold) {
  const CylinderBodyOptions options;
  const ResponseDatabase database = cylinder_body(options);
  EXPECT_NO_THROW(check(database));
  EXPECT_GE(triangle_neighbours(database.body.triangle).minCoeff(), 0);
  // A prism of n sides: n/2 sin(2 pi/n) / pi of the circle, less what the turned rings
  // cut off (of second order, too).
  const double round = std::numbers::pi * options.radius_m * options.radius_m;
  const double volume = enclosed_volume_m3(database.body);
  EXPECT_LT(volume, round * options.length_m);
  EXPECT_GT(volume, 0.99 * round * options.length_m);
}

TEST(CylinderBody, EveryNodeOfTheSideHasTheCurve) {
  const CylinderBodyOptions options;
  const ResponseDatabase database = cylinder_body(options);
  const ResponseTable& table = database.tools[0];
  const std::int64_t middle = options.around * options.along / 2;
  for (const double d : {0.001, 0.0033, 0.005, 0.008}) {
    // A cubic through exact samples of a quadratic; at the bend within its step.
    EXPECT_NEAR(table.curve(middle).at(d).force_n,
                cylinder_force_n(options.stiffness_n_per_m, d), 1e-3);
  }
  EXPECT_TRUE(table.curve(0).depth_m.empty());
  EXPECT_TRUE(table.curve(table.nodes() - 1).depth_m.empty());
}

}  // namespace
}  // namespace palpate
