#include "runtime/c_api/body_placement.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

const Eigen::Vector3d kSomewhere(0.3, -0.1, 0.7);
// A quarter about z: x becomes y.
const Eigen::Vector4d kQuarter(0.0, 0.0, std::sqrt(0.5), std::sqrt(0.5));
const Eigen::Vector3d kPoint(0.011, 0.023, -0.037);

BodyPlacement placed(const Eigen::Vector4d& quaternion) {
  BodyPlacement placement;
  EXPECT_TRUE(placement.place(kSomewhere, quaternion));
  return placement;
}

TEST(BodyPlacement, UntilItIsPlacedTheWorldIsTheBodys) {
  const BodyPlacement placement;
  EXPECT_EQ(placement.point_in_body(kPoint), kPoint);
  EXPECT_EQ(placement.point_in_world(kPoint), kPoint);
  EXPECT_EQ(placement.vector_in_body(kPoint), kPoint);
  EXPECT_EQ(placement.vector_in_world(kPoint), kPoint);
  // No orientation stays none.
  EXPECT_EQ(placement.turn_in_body(Eigen::Vector4d::Zero()), Eigen::Vector4d::Zero());
}

TEST(BodyPlacement, AQuarterAboutZTakesXToYAndTheOriginAlong) {
  const BodyPlacement placement = placed(kQuarter);
  const Eigen::Vector3d x(2.0, 0.0, 0.0), y(0.0, 2.0, 0.0);
  EXPECT_TRUE(placement.point_in_world(x).isApprox(kSomewhere + y, 1e-15));
  EXPECT_TRUE(placement.vector_in_world(x).isApprox(y, 1e-15));
  EXPECT_TRUE(placement.point_in_body(kSomewhere + y).isApprox(x, 1e-14));
  EXPECT_TRUE(placement.vector_in_body(y).isApprox(x, 1e-15));
}

TEST(BodyPlacement, ThereAndBackIsTheSame) {
  const BodyPlacement placement = placed({0.1, -0.7, 0.4, 0.3});
  const Eigen::Vector3d there = placement.point_in_world(kPoint);
  EXPECT_GT((there - kPoint).norm(), 0.1);
  EXPECT_NEAR((placement.point_in_body(there) - kPoint).norm(), 0.0, 1e-15);
  const Eigen::Vector3d turned = placement.vector_in_world(kPoint);
  EXPECT_NEAR((placement.vector_in_body(turned) - kPoint).norm(), 0.0, 1e-16);
}

// F . v is the same in both frames: a placement gives a hand no energy.
TEST(BodyPlacement, PowerIsThatOfTheBody) {
  const BodyPlacement placement = placed({0.1, -0.7, 0.4, 0.3});
  const Eigen::Vector3d force(1.0, -2.0, 0.5), torque(0.02, 0.01, -0.03);
  const Eigen::Vector3d moved_to = kPoint + Eigen::Vector3d(1e-3, 2e-3, -3e-3);
  const Eigen::Vector3d spin(0.4, -0.2, 0.9);
  const Wrench world = placement.in_world(Wrench{force, torque});
  const Eigen::Vector3d moved =
      placement.point_in_body(moved_to) - placement.point_in_body(kPoint);
  // Places within a metre are rounded to 1e-16 m, forces are of 2 N.
  EXPECT_NEAR(world.force_n.dot(moved_to - kPoint), force.dot(moved), 1e-15);
  EXPECT_NEAR(world.torque_n_m.dot(spin), torque.dot(placement.vector_in_body(spin)),
              1e-17);
  const Wrench back = placement.in_body(world);
  EXPECT_NEAR((back.force_n - force).norm(), 0.0, 1e-15);
  EXPECT_NEAR((back.torque_n_m - torque).norm(), 0.0, 1e-16);
}

TEST(BodyPlacement, AQuaternionMayHaveAnyLengthButZero) {
  const BodyPlacement unit = placed(kQuarter);
  for (const double length : {1e-300, 1e-160, 3.0, 1e160, 1e300}) {
    const BodyPlacement placement = placed(length * kQuarter);
    EXPECT_TRUE(
        placement.point_in_world(kPoint).isApprox(unit.point_in_world(kPoint), 1e-15))
        << length;
  }
}

TEST(BodyPlacement, WhatIsNoPlaceChangesNothing) {
  const Eigen::Vector4d upright(0.0, 0.0, 0.0, 1.0);
  for (const double bad : {std::nan(""), kInfinite, -kInfinite}) {
    BodyPlacement placement;
    EXPECT_FALSE(placement.place({0.0, bad, 0.0}, upright));
    EXPECT_FALSE(placement.place(kSomewhere, {0.0, bad, 0.0, 1.0}));
    EXPECT_FALSE(placement.place(kSomewhere, Eigen::Vector4d::Zero()));
    EXPECT_EQ(placement.point_in_world(kPoint), kPoint) << bad;
  }
  BodyPlacement placement = placed(kQuarter);
  const Eigen::Vector3d before = placement.point_in_world(kPoint);
  EXPECT_FALSE(placement.place({kInfinite, 0.0, 0.0}, upright));
  EXPECT_EQ(placement.point_in_world(kPoint), before);
}

// A tool that turns with the body does not turn over it.
TEST(BodyPlacement, TurnsOfAToolAreRelativeToTheBody) {
  const BodyPlacement placement = placed(kQuarter);
  EXPECT_TRUE(placement.turn_in_body(kQuarter).isApprox(
      Eigen::Vector4d(0.0, 0.0, 0.0, 1.0), 1e-15));
  const Eigen::Quaterniond tool(Eigen::Vector4d(0.5, -0.1, 0.3, 0.8).normalized());
  const Eigen::Quaterniond over(placement.turn_in_body(tool.coeffs()));
  const Eigen::Vector3d way = tool * kPoint;
  EXPECT_TRUE((over * kPoint).isApprox(placement.vector_in_body(way), 1e-14));
}

TEST(BodyPlacement, AToolWithoutATurnLiesAlongTheWorld) {
  const BodyPlacement placement = placed(kQuarter);
  EXPECT_EQ(placement.turn_in_body(Eigen::Vector4d::Zero()),
            placement.turn_in_body({0.0, 0.0, 0.0, 1.0}));
}

}  // namespace
}  // namespace palpate
