// delta_0, the relaxed state that the account has to take where a stiffer element comes
// than it can pay for: how it comes, how it goes, in both local models.
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

constexpr double kHeldStiffness = 250.0;  // [N/m] of every node
constexpr double kHeldDepth = 3e-3;       // [m]

class RelaxedState : public testing::TestWithParam<LocalModel> {
 protected:
  RelaxedState() {
    state_->config.model = GetParam();
    state_->config.force_max_n = 1e3;
    state_->config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
    make_stiff(1.0);
  }

  void make_stiff(double factor) {
    for (Element& element : body_.element) {
      for (ElementNode& node : element.node) {
        set_power_law(node, 1.0, factor * kHeldStiffness * 0.008, 0.008);
      }
    }
  }

  FastCommand go(double depth_m, bool update = false) {
    const Eigen::Vector3d x(0.031, 0.0306, -depth_m);
    if (update) {
      send(*state_, body_, x);
    }
    return step(*state_, {x, 0}, kTickS);
  }

  void press() {
    for (int n = -20; n <= 300; ++n) {
      (void)go(kHeldDepth * n / 300.0, true);
    }
  }

  BenchBody body_ = make_bench_body({.exponent = 1.0});
  std::unique_ptr<FastState> state_ = std::make_unique<FastState>();
};

INSTANTIATE_TEST_SUITE_P(Models, RelaxedState,
                         testing::Values(LocalModel::kElement, LocalModel::kPotential),
                         [](const auto& model) {
                           return std::string(name(model.param));
                         });

TEST_P(RelaxedState, ANewerCopyActsAtTheTickInWhichItCame) {
  press();
  make_stiff(0.5);
  const FastCommand command = go(kHeldDepth, true);
  EXPECT_NEAR(command.force_n.z(), 0.5 * kHeldStiffness * kHeldDepth, 1e-9);
  EXPECT_EQ(command.rest_offset_m, 0.0);
}

// k' (d - delta)^2 = k d^2: what was stored, and no more.
TEST_P(RelaxedState, AStifferCopyIsMovedDeeper) {
  press();
  make_stiff(4.0);
  const FastCommand command = go(kHeldDepth, true);
  EXPECT_NEAR(command.rest_offset_m, 0.5 * kHeldDepth, 1e-6 * kHeldDepth);
  EXPECT_NEAR(command.force_n.z(), 4.0 * kHeldStiffness * 0.5 * kHeldDepth, 1e-4);
}

// As fast as recovery_m_per_s, once there is energy for it.
TEST_P(RelaxedState, ItIsBledBackAtItsSpeed) {
  press();
  make_stiff(4.0);
  double shift_m = go(kHeldDepth, true).rest_offset_m;
  for (int n = 0; n < 20; ++n) {
    state_->ledger.tank_j += 1e-3;  // as if others had freed it
    state_->ledger.work_j += 1e-3;
    const double now_m = go(kHeldDepth).rest_offset_m;
    EXPECT_NEAR(shift_m - now_m, state_->config.recovery_m_per_s * kTickS, 1e-12);
    shift_m = now_m;
  }
}

// A tool that leaves meets the surface again where it is.
TEST_P(RelaxedState, ItSinksWithAToolThatLeaves) {
  press();
  make_stiff(4.0);
  (void)go(kHeldDepth, true);
  (void)go(0.4 * kHeldDepth);  // above the shifted surface
  EXPECT_NEAR(go(0.3 * kHeldDepth).rest_offset_m, 0.3 * kHeldDepth, 1e-12);
  EXPECT_EQ(go(-1e-4).rest_offset_m, 0.0);
  (void)go(0.0);
  EXPECT_NEAR(go(1e-3).force_n.z(), 4.0 * kHeldStiffness * 1e-3, 1e-9);
}

}  // namespace
}  // namespace palpate
