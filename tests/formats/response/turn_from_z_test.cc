#include "formats/response/turn_from_z.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace palpate {
namespace {

void expect_least_turn(const Eigen::Vector3d& axis) {
  const Eigen::Quaterniond turn = turn_from_z(axis);
  EXPECT_NEAR(turn.norm(), 1.0, 1e-15);
  EXPECT_NEAR((turn * Eigen::Vector3d::UnitZ() - axis).norm(), 0.0, 1e-15);
  EXPECT_NEAR(turn.angularDistance(Eigen::Quaterniond::Identity()),
              std::atan2(std::hypot(axis.x(), axis.y()), axis.z()), 1e-12);
}

TEST(TurnFromZ, IsTheLeastThatTakesZThere) {
  for (int polar = 0; polar <= 40; ++polar) {
    for (int around = 0; around < 12; ++around) {
      const double a = polar * std::numbers::pi / 40.0;
      const double b = around * std::numbers::pi / 6.0;
      expect_least_turn(
          {std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)});
    }
  }
}

TEST(TurnFromZ, KeepsItsDigitsAtBothEnds) {
  for (const double small : {1e-3, 1e-9, 1e-200}) {
    for (const double z : {1.0, -1.0}) {
      const Eigen::Quaterniond turn = turn_from_z({small, 0.0, z});
      const double half = 0.5 * small;
      EXPECT_NEAR((z > 0.0 ? turn.y() : turn.w()) / half, 1.0, 1e-6);
      EXPECT_EQ(turn.x(), 0.0);
    }
  }
  EXPECT_TRUE(
      turn_from_z(Eigen::Vector3d::UnitZ()).isApprox(Eigen::Quaterniond::Identity()));
  EXPECT_EQ(turn_from_z(-Eigen::Vector3d::UnitZ()).x(), 1.0);
  EXPECT_EQ(turn_from_z({6.0, 0.0, 8.0}).y(), turn_from_z({0.6, 0.0, 0.8}).y());
}

}  // namespace
}  // namespace palpate
