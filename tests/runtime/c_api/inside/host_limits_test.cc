#include "runtime/c_api/host_limits.h"

#include <cmath>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/said.h"

namespace palpate {
namespace {

// A device of 2 N s/m that holds forces for 1 ms: 4000 N/m by 2 b / T.
HostOptions damped_host() {
  HostOptions options;
  options.tick_s = 0.001;
  options.damping_n_s_per_m = 2.0;
  options.limit_stiffness = true;
  return options;
}

// One contact at the reference point.
ContactStiffness one_contact(double n_per_m) {
  ContactStiffness contacts;
  contacts.lever_m = Eigen::MatrixX3d::Zero(1, 3);
  contacts.n_per_m = Eigen::MatrixXd::Constant(1, 1, n_per_m);
  return contacts;
}

TEST(HostLimits, LimitsHoldAtTheDevice) {
  HostOptions options;
  options.model = LocalModel::kFacets;
  options.force_max_n = 6.0;
  options.force_gain = 4.0;
  options.ramp_s = 0.3;
  const ToolShape ball{"ball", "sphere", 0.005, 0.3, 0.0005};
  const FastConfig fast = fast_config(options, ball);
  EXPECT_DOUBLE_EQ(fast.force_max_n * options.force_gain, 6.0);
  EXPECT_DOUBLE_EQ(fast.slew_max_n_per_s * options.force_gain,
                   FastConfig{}.slew_max_n_per_s);
  EXPECT_EQ(fast.tool_radius_m, 0.005);
  EXPECT_EQ(fast.model, LocalModel::kFacets);
  EXPECT_EQ(fast.ramp_s, 0.3);
}

TEST(HostLimits, WithoutTheDevicesDampingNothingIsLimited) {
  HostOptions options = damped_host();
  options.damping_n_s_per_m = 0.0;
  options.limit_stiffness = false;
  EXPECT_EQ(renderable_scale(options, {.normal_n_per_m = 1e9}), 1.0);
  EXPECT_EQ(contacts_scale(options, one_contact(1e9)), 1.0);
  EXPECT_TRUE(std::isinf(renderable_n_per_m(options)));
}

// b > K T / 2 (Colgate & Schenkel), and b >= K (T/2 + delay) (Diolaiti et al.).
TEST(HostLimits, RenderableIsTwiceTheDampingOverTheTick) {
  HostOptions options = damped_host();
  EXPECT_DOUBLE_EQ(renderable_n_per_m(options), 4000.0);
  options.delay_s = 0.0015;
  EXPECT_DOUBLE_EQ(renderable_n_per_m(options), 1000.0);
}

TEST(HostLimits, GainsMultiplyWhatTheDeviceFeels) {
  HostOptions options = damped_host();
  options.position_gain = 0.5;
  options.force_gain = 4.0;
  EXPECT_DOUBLE_EQ(renderable_n_per_m(options), 2000.0);
  EXPECT_DOUBLE_EQ(renderable_scale(options, {.normal_n_per_m = 8000.0}), 0.25);
  EXPECT_NEAR(contacts_scale(options, one_contact(8000.0)), 0.25, 1e-12);
}

TEST(HostLimits, WhatIsSoftEnoughIsNotScaled) {
  const HostOptions options = damped_host();
  EXPECT_EQ(renderable_scale(options, {.normal_n_per_m = 4000.0}), 1.0);
  EXPECT_EQ(renderable_scale(options, {.normal_n_per_m = 1.0}), 1.0);
  EXPECT_EQ(contacts_scale(options, one_contact(3999.0)), 1.0);
}

TEST(HostLimits, TheScaleMakesTheStiffestJustRenderable) {
  for (const double delay_s : {0.0, 0.002}) {
    HostOptions options = damped_host();
    options.delay_s = delay_s;
    const double normal =
        renderable_scale(options, {.normal_n_per_m = 9000.0, .friction_n_per_m = 1.0});
    EXPECT_NEAR(normal * 9000.0, renderable_n_per_m(options), 1e-9);
    const double friction =
        renderable_scale(options, {.normal_n_per_m = 1.0, .friction_n_per_m = 7000.0});
    EXPECT_NEAR(friction * 7000.0, renderable_n_per_m(options), 1e-9);
    EXPECT_NEAR(contacts_scale(options, one_contact(9000.0)), normal, 1e-12);
  }
}

TEST(HostLimits, ContactsFarFromTheHandAreStiffInTurning) {
  HostOptions options = damped_host();
  options.angular_damping_n_m_s = 1e-4;
  ContactStiffness contacts = one_contact(1000.0);
  EXPECT_EQ(contacts_scale(options, contacts), 1.0);
  contacts.lever_m.row(0) << 0.1, 0.0, 0.0;
  const double scale = contacts_scale(options, contacts);
  EXPECT_LT(scale, 1.0);
  // A device that moves ten times as far has arms a tenth as long, and forces a tenth.
  options.position_gain = 10.0;
  options.force_gain = 0.1;
  EXPECT_EQ(contacts_scale(options, contacts), 1.0);
}

TEST(HostLimits, WithoutTheFlagTheScaleIsSaidAndRefused) {
  HostOptions options = damped_host();
  options.limit_stiffness = false;
  EXPECT_THROW((void)renderable_scale(options, {.normal_n_per_m = 8000.0}), InputError);
  const std::string one = refusal([&] {
    (void)renderable_scale(options, {.normal_n_per_m = 8000.0, .node = 3});
  });
  expect_says(one, "8000 N/m (node 3)");
  expect_says(one, "the flag to limit stiffness scales forces by 0.5");
  EXPECT_THROW((void)contacts_scale(options, one_contact(8000.0)), InputError);
  expect_says(refusal([&] {
                (void)contacts_scale(options, one_contact(8000.0));
              }),
              "the flag to limit stiffness scales forces by 0.5");
}

}  // namespace
}  // namespace palpate
