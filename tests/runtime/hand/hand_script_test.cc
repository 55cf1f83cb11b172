#include "runtime/hand/hand_script.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

HandScript script() {
  HandScript s;
  s.surface_m = {0.01, 0.02, 0.03};
  s.normal = Eigen::Vector3d(1.0, 2.0, 2.0).normalized();
  s.touch_m = 0.005;
  return s;
}

double height_m(const HandScript& s, double time_s) {
  return (s.at(time_s).position_m - s.surface_m).dot(s.normal) - s.touch_m;
}

TEST(HandScript, VelocityIsTheDerivativeOfPosition) {
  const HandScript s = script();
  const double h = 1e-6;
  for (double t = 0.001; t < 2.0 * s.duration_s; t += 0.0137) {
    const Eigen::Vector3d difference =
        (s.at(t + h).position_m - s.at(t - h).position_m) / (2.0 * h);
    EXPECT_LT((s.at(t).velocity_m_per_s - difference).norm(), 1e-6) << t;
  }
}

TEST(HandScript, StaysAboveTheSurfaceAtBothEndsOfARound) {
  const HandScript s = script();
  EXPECT_NEAR(height_m(s, 0.0), s.clear_m, 1e-15);
  EXPECT_NEAR(height_m(s, s.duration_s), s.clear_m, 1e-15);
  EXPECT_NEAR(height_m(s, 7.0 * s.duration_s), s.clear_m, 1e-15);
}

TEST(HandScript, IsStillBeforeTheFirstRound) {
  HandScript s = script();
  const HandScript at_once = s;
  s.still_s = 1.5;
  for (const double t : {0.0, 0.7, 1.5}) {
    EXPECT_EQ(s.at(t).position_m, at_once.at(0.0).position_m);
    EXPECT_EQ(s.at(t).velocity_m_per_s, Eigen::Vector3d::Zero());
  }
  EXPECT_EQ(s.at(2.5).position_m, at_once.at(1.0).position_m);
}

TEST(HandScript, ReachesItsDepthsAndKeepsItsDepthInTheCircle) {
  const HandScript s = script();
  double lowest = 1.0;
  double widest = 0.0;
  for (double t = 0.0; t < s.duration_s; t += 1e-3) {
    const Eigen::Vector3d r = s.at(t).position_m - s.surface_m;
    const double aside = (r - r.dot(s.normal) * s.normal).norm();
    lowest = std::min(lowest, height_m(s, t));
    widest = std::max(widest, aside);
    if (aside > 1e-6) {
      EXPECT_NEAR(height_m(s, t), -s.press_m, 1e-12);
    }
  }
  EXPECT_NEAR(lowest, -s.deeper_m, 1e-12);
  EXPECT_NEAR(widest, 2.0 * s.circle_m, 1e-6);
}

}  // namespace
}  // namespace palpate
