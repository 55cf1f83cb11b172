// What a force that is held for a tick gives a hand beyond the account: K dx^2 / 2 at
// most, K as palpate_needed_damping() has it, whatever the body does between its nodes.
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "runtime/c_api/host_body.h"
#include "tests/support/model_test_name.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

constexpr double kBallM = 0.005;
constexpr double kHoldS = 0.001;

// Nodes of up to nine times each other's stiffness, without friction.
std::shared_ptr<const ResponseDatabase> uneven_plate() {
  const auto uneven = [](Eigen::Index node, double d) {
    return 1e4 * (1.0 + 4.0 * (1.0 + std::sin(2.3 * static_cast<double>(node)))) * d *
           d;
  };
  return std::make_shared<const ResponseDatabase>(
      sample_database(plate(0.1, 20), ball(kBallM, 0.0, 5e-4), uneven, 0.01, 41));
}

// A hand that wanders within 25 mm and presses up to 4 mm.
class Wandering {
 public:
  Eigen::Vector3d next() {
    for (int i = 0; i < 3; ++i) {
      at_(i) += 2e-4 * normal_(random_) - 0.002 * at_(i);
    }
    return {3.0 * at_.x(), 3.0 * at_.y(), kBallM - 0.002 + 0.6 * at_.z()};
  }

 private:
  std::mt19937 random_{5};
  std::normal_distribution<double> normal_;
  Eigen::Vector3d at_ = Eigen::Vector3d::Zero();
};

class HeldForce : public testing::TestWithParam<LocalModel> {};

TEST_P(HeldForce, GivesNoMoreThanItsStiffnessAllows) {
  HostOptions options;
  options.model = GetParam();
  options.own_slow_steps = true;
  options.force_max_n = 100.0;
  options.ramp_s = 1e-6;
  HostBody body(uneven_plate(), options);
  HostTool& tool = body.add_tool();
  const double k_n_per_m = body.needed_damping_n_s_per_m() / (0.5 * kHoldS);
  Wandering hand;
  HostTick before;
  Eigen::Vector3d from_m = Eigen::Vector3d::Zero();
  int contacts = 0;
  for (int tick = 0; tick < 50'000; ++tick) {
    const Eigen::Vector3d to_m = hand.next();
    const HostTick now = tool.step(HostSample{.position_m = to_m});
    ASSERT_EQ(now.command.fault, 0);
    if (before.command.in_contact) {
      const Eigen::Vector3d moved_m = to_m - from_m;
      const double given_j =
          before.command.wrench[0].force_n.dot(moved_m) + now.work_j - before.work_j;
      // Rounding of an account of some joules.
      ASSERT_LE(given_j, 0.5 * k_n_per_m * moved_m.squaredNorm() * 1.01 + 1e-12)
          << tick;
      ++contacts;
    }
    before = now;
    from_m = to_m;
    if (tick % 10 == 0) {
      (void)body.slow_step();
    }
  }
  EXPECT_GT(contacts, 10'000);
}

INSTANTIATE_TEST_SUITE_P(Models, HeldForce,
                         testing::Values(LocalModel::kPotential, LocalModel::kElement,
                                         LocalModel::kEnergyTank,
                                         LocalModel::kEqualEnergy),
                         model_test_name);

}  // namespace
}  // namespace palpate
