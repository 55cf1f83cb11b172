// The hand behind a pointer: smooth, capped in speed, never past its goal.
#include "runtime/hand/pointer_hand.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr double kTickS = 5e-4;

TEST(PointerHand, ReachesTheStepsEndWithoutPassingIt) {
  PointerHand hand(Eigen::Vector3d::Zero());
  hand.point_at({0.02, 0.0, 0.0});
  double furthest = 0.0;
  for (int i = 0; i < 2000; ++i) {
    hand.advance(kTickS);
    furthest = std::max(furthest, hand.target().position_m.x());
  }
  EXPECT_LE(furthest, 0.02 + 1e-15);
  EXPECT_NEAR(hand.target().position_m.x(), 0.02, 1e-12);
}

TEST(PointerHand, IsNeverFasterThanTheCap) {
  PointerHand hand(Eigen::Vector3d::Zero());
  hand.point_at({5.0, -3.0, 1.0});
  double fastest = 0.0;
  for (int i = 0; i < 4000; ++i) {
    hand.advance(kTickS);
    fastest = std::max(fastest, hand.target().velocity_m_per_s.norm());
  }
  EXPECT_LE(fastest, PointerHand::kSpeedMPerS * (1.0 + 1e-12));
  // The goal moves in steps: (w T)^2 / 12 less at a tick's end.
  EXPECT_NEAR(fastest, PointerHand::kSpeedMPerS, 1e-5);
}

TEST(PointerHand, TurnsNoFasterThanAWristAndToTheEnd) {
  PointerHand hand(Eigen::Vector3d::Zero());
  const Eigen::Quaterniond wanted(Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitX()));
  hand.turn_to(wanted);
  double fastest = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Quaterniond before = hand.target().turn;
    hand.advance(kTickS);
    fastest = std::max(fastest, before.angularDistance(hand.target().turn) / kTickS);
  }
  EXPECT_NEAR(fastest, PointerHand::kTurnRadPerS, 1e-6);
  EXPECT_NEAR(hand.target().turn.angularDistance(wanted), 0.0, 1e-8);
}

TEST(PointerHand, DoesNotDependOnTheTickWhileTheGoalStands) {
  // One long step equals many short ones: the solution is exact.
  PointerHand once({0.0, 0.0, 0.01});
  PointerHand often({0.0, 0.0, 0.01});
  once.point_at({0.0, 0.0, 0.0102});
  often.point_at({0.0, 0.0, 0.0102});
  once.advance(1e-3);  // the goal arrives within this step
  often.advance(1e-3);
  once.advance(0.02);
  for (int i = 0; i < 200; ++i) {
    often.advance(1e-4);
  }
  EXPECT_NEAR(once.target().position_m.z(), often.target().position_m.z(), 1e-15);
  EXPECT_NEAR(once.target().velocity_m_per_s.z(), often.target().velocity_m_per_s.z(),
              1e-13);
}

}  // namespace
}  // namespace palpate
