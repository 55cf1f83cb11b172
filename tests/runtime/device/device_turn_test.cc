// Orientations that devices say: what is one, and whose zero it has.
#include "runtime/device/device_turn.h"

#include <gtest/gtest.h>

#include "tests/runtime/device/turns.h"

namespace palpate {
namespace {

TEST(ExactTurn, DividesByANormNearOneAndRefusesTheRest) {
  const Eigen::Quaterniond turn = about(Eigen::Vector3d(1, 2, 3).normalized(), 0.4);
  for (const double norm : {1.0, 0.991, 1.009}) {
    const auto found = exact_turn(Eigen::Quaterniond(norm * turn.coeffs()));
    ASSERT_TRUE(found);
    EXPECT_LT(found->angularDistance(turn), 1e-7);
    EXPECT_NEAR(found->norm(), 1.0, 1e-15);
  }
  for (const double norm : {0.0, 0.98, 1.02, -0.5, 1e300, kNan}) {
    EXPECT_FALSE(exact_turn(Eigen::Quaterniond(norm * turn.coeffs()))) << norm;
  }
  EXPECT_FALSE(exact_turn(Eigen::Quaterniond(1.0, 0.0, kNan, 0.0)));
}

TEST(ExactTurn, OfAMatrixIsARotationOrNothing) {
  const Eigen::Quaterniond turn = about(Eigen::Vector3d(1, -2, 3).normalized(), 2.9);
  Eigen::Matrix3d matrix = turn.toRotationMatrix();
  const auto found = exact_turn(Eigen::Matrix3d(1.002 * matrix));
  ASSERT_TRUE(found);
  EXPECT_LT(found->angularDistance(turn), 1e-2);
  EXPECT_FALSE(exact_turn(Eigen::Matrix3d(-matrix)));  // a mirror
  EXPECT_FALSE(exact_turn(Eigen::Matrix3d(1.1 * matrix)));
  EXPECT_FALSE(exact_turn(Eigen::Matrix3d(Eigen::Matrix3d::Zero())));
  matrix(1, 2) = kNan;
  EXPECT_FALSE(exact_turn(matrix));
}

TEST(TurnFromStart, IsAboutTheDevicesAxesWhereverTheGripsZeroIs) {
  const Eigen::Quaterniond zero = about(Eigen::Vector3d(3, 1, -1).normalized(), 1.3);
  const Eigen::Quaterniond turn = about(Eigen::Vector3d::UnitX(), 0.2);
  TurnFromStart from_start;
  EXPECT_LT(from_start(zero).angularDistance(Eigen::Quaterniond::Identity()), 1e-7);
  EXPECT_LT(from_start(turn * zero).angularDistance(turn), 1e-7);
}

}  // namespace
}  // namespace palpate
