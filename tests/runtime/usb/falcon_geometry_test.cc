#include "runtime/usb/falcon_geometry.h"

#include <cmath>
#include <random>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "runtime/usb/falcon_motors.h"

namespace palpate {
namespace {

constexpr int kPoses = 20'000;

// Of a cylinder about the middle, except where a leg is almost stretched: there its
// rate grows without bound, and no force is transmitted.
constexpr double kRatesMax = 60.0;  // [rad/m]; 30 in the middle

class FalconGeometry : public ::testing::Test {
 protected:
  Eigen::Vector3d position() {
    for (;;) {
      const Eigen::Vector3d p(0.045 * unit_(random_), 0.045 * unit_(random_),
                              0.125 + 0.045 * unit_(random_));
      if (p.head<2>().norm() <= 0.045 && inverse(p, pose_) &&
          pose_.rates.norm() < kRatesMax) {
        return p;
      }
    }
  }

  std::mt19937 random_{1};
  std::uniform_real_distribution<double> unit_{-1.0, 1.0};
  FalconPose pose_;
};

TEST_F(FalconGeometry, RatesAreTheDifferencesOfTheAngles) {
  constexpr double kStep = 1e-6;
  for (int i = 0; i < kPoses; ++i) {
    const Eigen::Vector3d p = position();
    const Eigen::Matrix3d rates = pose_.rates;
    for (int axis = 0; axis < 3; ++axis) {
      FalconPose more;
      FalconPose less;
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis);
      if (!inverse(p + step, more) || !inverse(p - step, less)) {
        continue;  // at the border
      }
      const Eigen::Vector3d difference = (more.theta1 - less.theta1) / (2.0 * kStep);
      ASSERT_LT((rates.col(axis) - difference).norm(), 1e-6 * (1.0 + rates.norm()))
          << p.transpose();
    }
  }
}

TEST_F(FalconGeometry, ForwardFindsThePositionAgainWarmInFourIterations) {
  int most = 0;
  for (int i = 0; i < kPoses; ++i) {
    const Eigen::Vector3d p = position();
    const Eigen::Vector3d theta1 = pose_.theta1;
    // 1 mm between two readings is 1 m/s at 1 kHz.
    Eigen::Vector3d before =
        p + 1e-3 * Eigen::Vector3d(unit_(random_), unit_(random_), unit_(random_));
    if (!inverse(before, pose_)) {
      before = p;
    }
    const FalconForward found = forward(theta1, before);
    ASSERT_TRUE(found.converged) << p.transpose();
    ASSERT_LT((found.position_m - p).norm(), 1e-10) << p.transpose();
    most = std::max(most, found.iterations);
  }
  EXPECT_LE(most, 4);
}

TEST_F(FalconGeometry, ForwardFindsThePositionFromTheMiddle) {
  int most = 0;
  for (int i = 0; i < kPoses; ++i) {
    const Eigen::Vector3d p = position();
    const Eigen::Vector3d theta1 = pose_.theta1;
    const FalconForward found = forward(theta1, falcon_centre_m());
    ASSERT_TRUE(found.converged) << p.transpose();
    ASSERT_LT((found.position_m - p).norm(), 1e-10) << p.transpose();
    most = std::max(most, found.iterations);
  }
  EXPECT_LE(most, 10);  // the last step only confirms
}

TEST_F(FalconGeometry, DoesNotReachEverything) {
  EXPECT_FALSE(inverse({0.5, 0.0, 0.11}, pose_));
  EXPECT_FALSE(inverse({0.0, 0.0, 0.5}, pose_));
  EXPECT_FALSE(inverse({std::nan(""), 0.0, 0.11}, pose_));
  EXPECT_FALSE(forward({std::nan(""), 0.0, 0.0}, falcon_centre_m()).converged);
}

TEST_F(FalconGeometry, OneCountIsAtMostAFifteenthOfAMillimetre) {
  double largest_m = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d p = position();
    auto counts = counts_of(pose_.theta1);
    const FalconForward at = forward(angles_of(counts), p);
    for (std::int16_t& count : counts) {
      ++count;
    }
    const FalconForward next = forward(angles_of(counts), p);
    if (at.converged && next.converged) {
      largest_m = std::max(largest_m, (next.position_m - at.position_m).norm());
    }
  }
  EXPECT_GT(largest_m, 2e-5);
  EXPECT_LT(largest_m, 7e-5);
}

TEST_F(FalconGeometry, MotorsGiveBackTheForceWithinTheirCounts) {
  for (int i = 0; i < 2000; ++i) {
    (void)position();
    const Eigen::Vector3d force(unit_(random_), unit_(random_), unit_(random_));
    const FalconMotors motors = motors_for(force, pose_.rates, 1.25);
    ASSERT_FALSE(motors.clamped);
    // Half a count on every leg, through the same rates.
    const double rounding = 0.5 * std::sqrt(3.0) * pose_.rates.norm() / (1e4 * 1.25);
    ASSERT_LT((force_of(motors.command, pose_.rates, 1.25) - force).norm(), rounding);
  }
}

TEST_F(FalconGeometry, AForceTooLargeKeepsItsDirection) {
  for (int i = 0; i < 2000; ++i) {
    (void)position();
    const Eigen::Vector3d force =
        100.0 * Eigen::Vector3d(unit_(random_), unit_(random_), 2.0 + unit_(random_));
    const FalconMotors motors = motors_for(force, pose_.rates, 1.0);
    ASSERT_TRUE(motors.clamped);
    for (const std::int16_t count : motors.command) {
      ASSERT_LE(std::abs(count), 4095);
    }
    const Eigen::Vector3d made = force_of(motors.command, pose_.rates, 1.0);
    ASSERT_GT(made.normalized().dot(force.normalized()), 1.0 - 1e-5);
  }
}

TEST_F(FalconGeometry, AForceThatIsNoNumberIsNoCommand) {
  (void)position();
  const FalconMotors motors = motors_for({std::nan(""), 0, 0}, pose_.rates, 1.0);
  EXPECT_EQ(motors.command, (std::array<std::int16_t, 3>{}));
}

}  // namespace
}  // namespace palpate
