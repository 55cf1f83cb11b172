// A response that falls with depth: beyond its last sample it holds its force.
#include <limits>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "runtime/bench/bench_body.h"
#include "runtime/fast/fast_step.h"
#include "tests/support/energy_account.h"
#include "tests/support/model_test_name.h"

namespace palpate {
namespace {

// 0.5 N at 2 mm, 0.3 N at 4 mm, falling by 200 N/m there.
void make_falling(ElementNode& node) {
  constexpr double kH = 2e-3;
  node.samples = 3;
  node.depth_m = {0.0, kH, 2.0 * kH};
  node.force_n = {0.0, 0.5, 0.3};
  node.stiffness_n_per_m = {500.0, 0.0, -200.0};
  node.energy_j[0] = 0.0;
  node.energy_j[1] = kH * 0.25 + kH * kH * 500.0 / 12.0;
  node.energy_j[2] = node.energy_j[1] + kH * 0.4 + kH * kH * 200.0 / 12.0;
}

BenchBody falling_body(double friction) {
  BenchBody body =
      make_bench_body({.friction_min = friction, .friction_max = friction});
  for (Element& element : body.element) {
    for (ElementNode& node : element.node) {
      make_falling(node);
    }
  }
  return body;
}

class FallingCurve : public testing::TestWithParam<LocalModel> {
 protected:
  FallingCurve() {
    state_->config.model = GetParam();
    state_->config.force_max_n = 1e3;
    state_->config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
  }

  FastCommand go(const Eigen::Vector3d& x) {
    send(*state_, body_, x);
    return account_.step(*state_, x);
  }

  std::unique_ptr<FastState> state_ = std::make_unique<FastState>();
  BenchBody body_ = falling_body(0.0);
  Account account_;
};

INSTANTIATE_TEST_SUITE_P(Models, FallingCurve,
                         testing::Values(LocalModel::kElement, LocalModel::kPotential,
                                         LocalModel::kEnergyTank,
                                         LocalModel::kEqualEnergy),
                         model_test_name);

TEST_P(FallingCurve, HoldsItsForceBeyondTheLastSample) {
  for (int n = -20; n <= 3300; ++n) {  // 33 mm deep
    const FastCommand command = go({0.031, 0.0306, -1e-5 * n});
    ASSERT_GE(command.force_n.z(), 0.0) << n;
    ASSERT_GE(command.stored_j, 0.0) << n;
    ASSERT_EQ(command.fault, 0) << n;
    if (n > 400 &&
        (GetParam() == LocalModel::kElement || GetParam() == LocalModel::kPotential)) {
      ASSERT_NEAR(command.force_n.z(), 0.3, 1e-9) << n;
    }
  }
}

TEST_P(FallingCurve, FrictionNeverFollowsTheMovement) {
  body_ = falling_body(0.5);
  for (const double depth : {0.001, 0.003, 0.006, 0.012, 0.03}) {
    state_ = std::make_unique<FastState>();
    state_->config.model = GetParam();
    (void)go({0.025, 0.0306, 1e-4});
    for (int n = 0; n <= 300; ++n) {
      (void)go({0.025, 0.0306, 1e-4 - (depth + 1e-4) * n / 300.0});
    }
    for (int n = 1; n <= 200; ++n) {
      const FastCommand command = go({0.025 + 1e-5 * n, 0.0306, -depth});
      ASSERT_LE(command.force_n.x(), 1e-12) << depth << " " << n;
    }
  }
}

TEST_P(FallingCurve, WhatFrictionTookIsNotLentToTheClamps) {
  // 1 J rubbed off first; then taps that a slow clamp follows late.
  body_ = make_bench_body(
      {.exponent = 1.0, .force_n = 8.0, .friction_min = 0.5, .friction_max = 0.5});
  for (int n = 0; n <= 500; ++n) {
    (void)go({0.03, 0.03, 1e-3 - 6e-6 * n});
  }
  for (int n = 0; n < 80'000; ++n) {
    (void)go({0.03 + 0.01 * std::sin(0.02 * n), 0.03, -2e-3});
  }
  const bool rubs =
      GetParam() == LocalModel::kElement || GetParam() == LocalModel::kPotential;
  if (rubs) {
    ASSERT_GT(state_->ledger.dissipated_j, 0.3);
  }
  for (int n = 0; n <= 500; ++n) {
    (void)go({0.03, 0.03, -2e-3 + 6e-6 * n});
  }
  ASSERT_EQ(state_->safety.fault, Fault::kNone);
  state_->config.slew_max_n_per_s = 20.0;
  double hand_j = 0.0;
  Eigen::Vector3d held = Eigen::Vector3d::Zero();
  Eigen::Vector3d before(0.03, 0.03, 1e-3);
  for (int tap = 0; tap < 300 && state_->safety.fault == Fault::kNone; ++tap) {
    for (int n = 0; n < 240; ++n) {  // 3 mm in, out, 120 ms
      const double depth = 3e-3 * std::sin(3.14159265 * n / 240.0);
      const Eigen::Vector3d x(0.03, 0.03, 1e-3 - 1e-3 - depth);
      hand_j -= held.dot(x - before);
      held = go(x).force_n;
      before = x;
    }
  }
  // Work of the hand: never more than the floor below zero, with or without a fault.
  EXPECT_GE(hand_j, -1.5 * state_->config.energy_floor_j);
}

}  // namespace
}  // namespace palpate
