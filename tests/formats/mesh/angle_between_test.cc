#include "formats/mesh/angle_between.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace palpate {
namespace {

const Eigen::Vector3d kX = Eigen::Vector3d::UnitX();

TEST(AngleBetween, IsTheAngleWhateverTheLengths) {
  for (int i = 1; i < 100; ++i) {
    const double angle = i * std::numbers::pi / 100.0;
    const Eigen::Vector3d b(0.2 * std::cos(angle), 0.0, 0.2 * std::sin(angle));
    EXPECT_NEAR(angle_between(3.0 * kX, b), angle, 1e-14);
  }
}

TEST(AngleBetween, IsAccurateAtBothEnds) {
  EXPECT_EQ(angle_between(kX, 2.0 * kX), 0.0);
  EXPECT_EQ(angle_between(kX, -kX), std::numbers::pi);
  EXPECT_EQ(angle_between(kX, Eigen::Vector3d::Zero()), 0.0);
  EXPECT_NEAR(angle_between(kX, {1.0, 1e-9, 0.0}), 1e-9, 1e-23);
}

}  // namespace
}  // namespace palpate
