// Responses at the ends of what a database may hold.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "runtime/bench/bench_body.h"
#include "runtime/fast/fast_step.h"
#include "tests/support/energy_account.h"
#include "tests/support/tick.h"

namespace palpate {
namespace {

std::unique_ptr<FastState> make_state(LocalModel model, double radius_m) {
  auto state = std::make_unique<FastState>();
  state->config.model = model;
  state->config.tool_radius_m = radius_m;
  state->config.force_max_n = std::numeric_limits<double>::infinity();
  state->config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
  return state;
}

class ResponseExtremes : public testing::TestWithParam<LocalModel> {};

INSTANTIATE_TEST_SUITE_P(Models, ResponseExtremes,
                         testing::Values(LocalModel::kElement, LocalModel::kPotential),
                         [](const auto& model) {
                           return std::string(name(model.param));
                         });

TEST(FieldExtremes, LinesFromAMillinewtonToTenMeganewtonsPerMetreAreRendered) {
  constexpr double kDepthM = 0.008;
  for (double k = 1e-3; k < 2e7; k *= 10.0) {
    const BenchBody body = make_bench_body({.exponent = 1.0, .force_n = k * kDepthM});
    const auto state = make_state(LocalModel::kPotential, 0.0);
    Account account;
    for (int n = -20; n <= 700; ++n) {  // down, 1 mm aside, up
      const double depth = 1e-5 * (n < 350 ? n : 700 - n);
      const Eigen::Vector3d x(0.031 + 1e-6 * n, 0.0306, -depth);
      if (n % 20 == 0) {
        send(*state, body, x);
      }
      const FastCommand command = account.step(*state, x);
      // Depths to the rounding of coordinates of 30 mm, 1e-17 m.
      ASSERT_NEAR(command.force_n.z(), k * std::max(0.0, depth), 1e-14 * k) << k;
    }
    EXPECT_EQ(state->safety.fault, Fault::kNone) << k;
    // 700 energies below k / 2 (3.5 mm)^2, rounded.
    EXPECT_GE(account.lowest_j, -1e-17 * k) << k;
  }
}

TEST_P(ResponseExtremes, DepthsFromANanometreToAMetreAreRendered) {
  const BenchBody body = make_bench_body({.exponent = 1.0, .depth_m = 1.0});
  const CurveView curve = body.element[0].node[0].curve();
  const auto state = make_state(GetParam(), 0.0);
  Eigen::Vector3d x(0.031, 0.0306, 0.001);
  send(*state, body, x);
  (void)step(*state, {x, 0}, kTickS);
  for (double depth = 1e-9; depth < 1.0; depth *= 1.05) {
    x.z() = -depth;
    send(*state, body, x);
    const FastCommand command = step(*state, {x, 0}, kTickS);
    ASSERT_NEAR(command.force_n.z(), curve.at(depth).force_n, 1e-14 + 1e-12 * depth);
    ASSERT_FALSE(command.extrapolated);
  }
  x.z() = -2.0;
  EXPECT_TRUE(step(*state, {x, 0}, kTickS).extrapolated);
  EXPECT_EQ(state->safety.fault, Fault::kNone);
}

TEST_P(ResponseExtremes, NeighboursThatDifferAMillionfoldStayPassiveAndFinite) {
  for (const double friction : {0.0, 1.0, 10.0}) {
    const BenchBody body = make_bench_body({.wave_m = 0.004,
                                            .contrast = 1e6,
                                            .tilt_rad = 0.2,
                                            .friction_min = friction,
                                            .friction_max = friction});
    const auto state = make_state(GetParam(), 0.005);
    Account account;
    double force_max_n = 0.0;
    int n = 0;
    int contacts = 0;
    for (const Eigen::Vector3d& x : make_bench_walk(body, {.ticks = 50'000})) {
      if (n++ % 20 == 0) {
        send(*state, body, x);
      }
      const FastCommand command = account.step(*state, x);
      ASSERT_TRUE(command.force_n.allFinite()) << n;
      force_max_n = std::max(force_max_n, command.force_n.norm());
      contacts += command.in_contact ? 1 : 0;
    }
    EXPECT_EQ(state->safety.fault, Fault::kNone) << friction;
    // The stiffest node stores 6.4 J at 8 mm: 5e4 sums, each rounded at 1e-15 J.
    EXPECT_GE(account.lowest_j, -1e-10) << friction;
    EXPECT_LT(state->ledger.created_j, 1e-10) << friction;
    EXPECT_GT(contacts, 10'000) << friction;
    // 2 kN at 8 mm, mu times that aside, and energies that fall over an edge of 5 mm.
    EXPECT_LT(force_max_n, 2000.0 * (1.0 + friction) + 6.4 / 0.005 * 20.0) << friction;
  }
}

TEST_P(ResponseExtremes, SlidingUnderTenIsCoulombs) {
  const BenchBody body =
      make_bench_body({.exponent = 1.0, .friction_min = 10.0, .friction_max = 10.0});
  const auto state = make_state(GetParam(), 0.0);
  Eigen::Vector3d x(0.025, 0.0306, 0.0005);
  FastCommand command;
  for (int n = 0; n < 8000; ++n) {
    if (n < 3000) {
      x.z() -= 1e-6;
    } else {
      x.x() += 1e-6;
    }
    if (n % 20 == 0) {
      send(*state, body, x);
    }
    command = step(*state, {x, 0}, kTickS);
  }
  EXPECT_NEAR(command.force_n.x(), -10.0 * command.force_n.z(), 1e-8);
  EXPECT_GT(command.force_n.z(), 0.1);
}

}  // namespace
}  // namespace palpate
