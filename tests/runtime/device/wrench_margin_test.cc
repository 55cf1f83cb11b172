#include "runtime/device/wrench_margin.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

ContactStiffness two(double apart_m, double own, double other) {
  ContactStiffness contacts;
  contacts.lever_m.resize(2, 3);
  contacts.lever_m << 0.5 * apart_m, 0.0, 0.0, -0.5 * apart_m, 0.0, 0.0;
  contacts.n_per_m.resize(2, 2);
  contacts.n_per_m << own, other, other, own;
  return contacts;
}

// One contact at the reference point: K T / 2 <= b.
TEST(WrenchMargin, OneContactIsColgatesBound) {
  ContactStiffness one;
  one.lever_m = Eigen::MatrixX3d::Zero(1, 3);
  one.n_per_m = Eigen::MatrixXd::Constant(1, 1, 400.0);
  const WrenchMargin margin = wrench_margin(one, 0.5, 0.0, 0.001, 0.002);
  EXPECT_NEAR(margin.share, 400.0 * 0.0025 / 0.5, 1e-12);
  EXPECT_NEAR(margin.stiffness_n_per_m, 400.0, 1e-9);
  EXPECT_NEAR(margin.stiffness_n_m_per_rad, 0.0, 1e-12);
  EXPECT_NE(why_not_renderable(margin, 0.5, 0.0).find("pressing"), std::string::npos);
}

// The spring of friction acts across the normal: the larger of the two bounds.
TEST(WrenchMargin, FrictionIsStiffToo) {
  ContactStiffness one;
  one.lever_m = Eigen::MatrixX3d::Zero(1, 3);
  one.n_per_m = Eigen::MatrixXd::Constant(1, 1, 400.0);
  one.friction_n_per_m = 300.0;
  EXPECT_NEAR(wrench_margin(one, 0.5, 0.0, 0.001, 0.0).stiffness_n_per_m, 400.0, 1e-9);
  one.friction_n_per_m = 900.0;
  EXPECT_NEAR(wrench_margin(one, 0.5, 0.0, 0.001, 0.0).stiffness_n_per_m, 900.0, 1e-9);
}

// Two at arms r: 2 k in pressing, 2 k r^2 in turning; coupling softens pressing and
// stiffens turning.
TEST(WrenchMargin, LeversTurn) {
  const WrenchMargin free = wrench_margin(two(0.2, 100.0, 0.0), 10.0, 1e-4, 0.001, 0.0);
  EXPECT_NEAR(free.stiffness_n_per_m, 200.0, 1e-9);
  EXPECT_NEAR(free.stiffness_n_m_per_rad, 2.0, 1e-9);
  EXPECT_NEAR(free.share, 2.0 * 0.0005 / 1e-4, 1e-9);
  EXPECT_GT(free.angular_share, 0.9);
  EXPECT_NE(why_not_renderable(free, 10.0, 1e-4).find("turning"), std::string::npos);
  const WrenchMargin coupled =
      wrench_margin(two(0.2, 100.0, -20.0), 10.0, 1e-1, 0.001, 0.0);
  EXPECT_NEAR(coupled.stiffness_n_per_m, 160.0, 1e-9);
  EXPECT_NEAR(coupled.stiffness_n_m_per_rad, 2.4, 1e-9);
  EXPECT_EQ(why_not_renderable(coupled, 10.0, 1e-1), "");
}

}  // namespace
}  // namespace palpate
