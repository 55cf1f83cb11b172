// Bad samples, bad elements, bad configurations: defined behaviour of the fast step.
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/bench/bench_body.h"
#include "runtime/fast/fast_step.h"
#include "tests/runtime/fast/pressed_middle.h"
#include "tests/support/energy_account.h"
#include "tests/support/tick.h"

namespace palpate {
namespace {

TEST(FastStepFault, NotANumberIsALatchedFault) {
  const BenchBody body = make_bench_body({});
  FastState state = pressed(body, over_middle(body, 0.0));
  (void)step(state, {over_middle(body, 0.001), 0}, kTickS);
  const FastCommand bad =
      step(state, {{0.0, std::numeric_limits<double>::quiet_NaN(), 0.0}, 0}, kTickS);
  EXPECT_EQ(bad.fault, static_cast<std::uint8_t>(Fault::kNotFinite));
  EXPECT_EQ(bad.force_n.norm(), 0.0);
  const FastCommand after = step(state, {over_middle(body, 0.003), 0}, kTickS);
  EXPECT_EQ(after.fault, static_cast<std::uint8_t>(Fault::kNotFinite));
  EXPECT_EQ(after.force_n.norm(), 0.0);
  EXPECT_TRUE(std::isfinite(after.stored_j));
}

TEST(FastStepFault, NotANumberInAnElementIsAFaultWithFiniteAccount) {
  const BenchBody body = make_bench_body({});
  FastState state = element_state(0.0);
  const Eigen::Vector3d x = over_middle(body, -0.001);
  Element broken = body.element[static_cast<std::size_t>(body.triangle_at(x))];
  broken.active = true;
  broken.node[1].force_n.fill(std::numeric_limits<double>::quiet_NaN());
  accept(state, broken);
  (void)step(state, {x, 0}, kTickS);
  const FastCommand command = step(state, {over_middle(body, 0.003), 0}, kTickS);
  EXPECT_EQ(command.fault, static_cast<std::uint8_t>(Fault::kNotFinite));
  EXPECT_EQ(command.force_n.norm(), 0.0);
  EXPECT_TRUE(std::isfinite(command.stored_j));
}

TEST(FastStepFault, NoTimeLeavesTheForceAndBadTimeIsAFault) {
  const BenchBody body = make_bench_body({});
  FastState state = pressed(body, over_middle(body, 0.0));
  (void)step(state, {over_middle(body, -0.001), 0}, kTickS);
  const FastCommand before = step(state, {over_middle(body, 0.002), 0}, kTickS);
  const FastCommand still = step(state, {over_middle(body, 0.002), 0}, 0.0);
  EXPECT_EQ((still.force_n - before.force_n).norm(), 0.0);
  EXPECT_EQ(still.fault, 0);
  const FastCommand bad = step(state, {over_middle(body, 0.002), 0}, -1.0);
  EXPECT_EQ(bad.fault, static_cast<std::uint8_t>(Fault::kTimeStep));
}

TEST(FastStepFault, DegenerateElementAndSlopesOfZeroStayFinite) {
  const BenchBody body = make_bench_body({});
  Element flat = body.element[0];
  flat.active = true;
  flat.node[1].position_m = flat.node[0].position_m;
  for (ElementNode& node : flat.node) {
    node.stiffness_n_per_m.fill(0.0);
    node.friction = 10.0;
  }
  FastState state = element_state(0.0);
  accept(state, flat);
  for (int n = -50; n < 400; ++n) {
    const Eigen::Vector3d x(1e-5 * n, 2e-5 * n, -1e-5 * n);
    const FastCommand command = step(state, {x, 0}, kTickS);
    ASSERT_TRUE(command.force_n.allFinite());
    ASSERT_EQ(command.fault, 0);
  }
}

// Wherever it stands: one that a comparison would pass by is a fault, too.
TEST(FastStepFault, WhatIsNotFiniteAnywhereInAnElementIsNotTakenIn) {
  const BenchBody body = make_bench_body({});
  using Place = Real& (*)(ElementNode&);
  const std::vector<Place> places{[](ElementNode& n) -> Real& {
                                    return n.position_m[1];
                                  },
                                  [](ElementNode& n) -> Real& {
                                    return n.normal[2];
                                  },
                                  [](ElementNode& n) -> Real& {
                                    return n.direction[0];
                                  },
                                  [](ElementNode& n) -> Real& {
                                    return n.tilt[2];
                                  },
                                  [](ElementNode& n) -> Real& {
                                    return n.tilt_by_height_per_m[0];
                                  },
                                  [](ElementNode& n) -> Real& {
                                    return n.touch_offset_m;
                                  },
                                  [](ElementNode& n) -> Real& {
                                    return n.friction;
                                  },
                                  [](ElementNode& n) -> Real& {
                                    return n.presliding_m;
                                  },
                                  [](ElementNode& n) -> Real& {
                                    return n.depth_m[3];
                                  },
                                  [](ElementNode& n) -> Real& {
                                    return n.force_n[3];
                                  },
                                  [](ElementNode& n) -> Real& {
                                    return n.stiffness_n_per_m[3];
                                  },
                                  [](ElementNode& n) -> Real& {
                                    return n.energy_j[3];
                                  }};
  constexpr Real kEndless = std::numeric_limits<Real>::infinity();
  for (const Place place : places) {
    for (const Real wrong :
         {std::numeric_limits<Real>::quiet_NaN(), kEndless, -kEndless}) {
      for (const LocalModel model : {LocalModel::kElement, LocalModel::kPotential}) {
        FastState state = element_state(0.0);
        state.config.model = model;
        const Eigen::Vector3d x = over_middle(body, 0.001);
        Element broken = body.element[static_cast<std::size_t>(body.triangle_at(x))];
        broken.active = true;
        place(broken.node[1]) = wrong;
        accept(state, broken);
        EXPECT_EQ(step(state, {x, 0}, kTickS).fault,
                  static_cast<std::uint8_t>(Fault::kNotFinite));
        EXPECT_EQ(state.cache.received, 0U);
      }
    }
  }
}

TEST(FastStepFault, MalformedElementsAreRefused) {
  const BenchBody body = make_bench_body({});
  FastState state = element_state();
  Element bad = body.element[0];
  bad.node[2].samples = 49;
  accept(state, bad);
  bad.node[2].samples = -1;
  accept(state, bad);
  accept(state, Element{});
  EXPECT_EQ(state.cache.rejected, 3U);
  EXPECT_EQ(state.cache.received, 0U);
}

TEST(FastStepFault, FaultRaisedOutsideIsKept) {
  FastState state = element_state();
  raise_fault(state, Fault::kDeviceLost);
  raise_fault(state, Fault::kSlowStalled);
  const FastCommand command = step(state, {}, kTickS);
  EXPECT_EQ(command.fault, static_cast<std::uint8_t>(Fault::kDeviceLost));
}

TEST(FastStepFault, ConfigurationIsChecked) {
  FastConfig config;
  EXPECT_EQ(check(config), nullptr);
  config.force_max_n = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(check(config), nullptr);
  config = {};
  config.tool_radius_m = -0.001;
  EXPECT_NE(check(config), nullptr);
}

}  // namespace
}  // namespace palpate
