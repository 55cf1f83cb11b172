#include "runtime/usb/pantograph.h"

#include <cmath>
#include <numbers>
#include <random>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr int kPantographPoses = 20'000;

class Pantograph : public ::testing::TestWithParam<PantographLinks> {
 protected:
  PantographPose pose() {
    for (;;) {
      const Eigen::Vector2d theta(std::numbers::pi * unit_(random_),
                                  std::numbers::pi * unit_(random_));
      PantographPose found;
      if (forward(GetParam(), theta, found) && found.transmission > 0.05) {
        return found;
      }
    }
  }

  std::mt19937 random_{1};
  std::uniform_real_distribution<double> unit_{-1.0, 1.0};
};

TEST_P(Pantograph, AnyReachablePositionIsOneOfTheTwoSidesOfItsAngles) {
  int tried = 0;
  while (tried < kPantographPoses) {
    const Eigen::Vector2d p(0.08 * unit_(random_), 0.11 * unit_(random_));
    Eigen::Vector2d theta;
    if (!inverse(GetParam(), p, theta)) {
      continue;
    }
    PantographLinks other = GetParam();
    other.side = -other.side;
    PantographPose here;
    PantographPose there;
    if (!forward(GetParam(), theta, here) || !forward(other, theta, there)) {
      continue;  // elbows together, links in line
    }
    const double nearest =
        std::min((here.position_m - p).norm(), (there.position_m - p).norm());
    // sqrt of rounding where the free links are nearly in line
    ASSERT_LT(nearest, here.transmission > 1e-3 ? 1e-10 : 1e-6) << p.transpose();
    ++tried;
  }
}

TEST_P(Pantograph, JacobianIsTheDifferenceOfPositions) {
  constexpr double kStep = 1e-6;
  for (int i = 0; i < kPantographPoses; ++i) {
    const PantographPose at = pose();
    for (int leg = 0; leg < 2; ++leg) {
      PantographPose more;
      PantographPose less;
      const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(leg);
      ASSERT_TRUE(forward(GetParam(), at.theta + step, more));
      ASSERT_TRUE(forward(GetParam(), at.theta - step, less));
      const Eigen::Vector2d difference =
          (more.position_m - less.position_m) / (2.0 * kStep);
      ASSERT_LT((at.jacobian.col(leg) - difference).norm(),
                1e-6 * (1.0 + at.jacobian.norm()));
    }
  }
}

TEST_P(Pantograph, TorquesDoTheWorkOfTheForce) {
  for (int i = 0; i < 2000; ++i) {
    const PantographPose at = pose();
    const Eigen::Vector2d force(unit_(random_), unit_(random_));
    const Eigen::Vector2d torque = torques_for(at, force, HUGE_VAL);
    if (at.transmission < kTransmissionMin) {
      EXPECT_EQ(torque.norm(), 0.0);
      continue;
    }
    const Eigen::Vector2d turn(unit_(random_), unit_(random_));
    ASSERT_NEAR(torque.dot(turn), force.dot(at.jacobian * turn), 1e-12);
    const Eigen::Vector2d clamped =
        torques_for(at, force, 0.25 * torque.cwiseAbs().maxCoeff());
    ASSERT_LT((clamped - 0.25 * torque).norm(), 1e-15);
  }
}

INSTANTIATE_TEST_SUITE_P(Links, Pantograph,
                         ::testing::Values(PantographLinks{},                         //
                                           PantographLinks{.elbow = -1},              //
                                           PantographLinks{.side = -1},               //
                                           PantographLinks{.side = -1, .elbow = -1},  //
                                           PantographLinks{.driven_m = 0.07,
                                                           .free_m = 0.09,
                                                           .base_m = 0.0}));

TEST(PantographPose, StandsWhereASymmetricFiveBarMust) {
  const PantographLinks links;
  PantographPose pose;
  ASSERT_TRUE(forward(links, {0.0, std::numbers::pi}, pose));
  // Elbows at +-60 mm, free links of 70 mm.
  EXPECT_NEAR(pose.position_m.x(), 0.0, 1e-15);
  EXPECT_NEAR(pose.position_m.y(), std::sqrt(0.07 * 0.07 - 0.06 * 0.06), 1e-15);
}

TEST(PantographPose, HasNoForceWhereItsFreeLinksLieInLine) {
  const PantographLinks links{.driven_m = 0.05, .free_m = 0.06, .base_m = 0.02};
  PantographPose pose;
  EXPECT_FALSE(forward(links, {0.0, std::numbers::pi}, pose));  // 2 x 60 mm apart
  ASSERT_TRUE(forward(links, {1e-3, std::numbers::pi - 1e-3}, pose));
  EXPECT_LT(pose.transmission, kTransmissionMin);
  EXPECT_EQ(torques_for(pose, {0.0, 1.0}, 0.123).norm(), 0.0);
}

TEST(PantographPose, DoesNotReachBeyondItsLinks) {
  Eigen::Vector2d theta;
  EXPECT_FALSE(inverse({}, {0.0, 0.2}, theta));
  EXPECT_FALSE(inverse({}, {0.01, 0.001}, theta));  // free link longer than driven
  EXPECT_FALSE(inverse({}, {std::nan(""), 0.1}, theta));
}

TEST(PantographLinksCheck, NamesWhatCannotBe) {
  EXPECT_THROW(check(PantographLinks{.driven_m = 0.0}), InputError);
  EXPECT_THROW(check(PantographLinks{.free_m = std::nan("")}), InputError);
  EXPECT_THROW(check(PantographLinks{.side = 0}), InputError);
  check(PantographLinks{});
}

}  // namespace
}  // namespace palpate
