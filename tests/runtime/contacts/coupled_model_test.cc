// The coupled model on its way over a body: energy, friction, late elements.
#include "runtime/contacts/coupled_model.h"

#include <cmath>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/coupled_plate.h"

namespace palpate {
namespace {

// 10^5 ticks; PALPATE_LONG_WALK=10000000 for the capability's.
TEST(CoupledModel, PoseWalksNeverGetEnergy) {
  const char* longer = std::getenv("PALPATE_LONG_WALK");
  const std::int64_t ticks = longer != nullptr ? std::atoll(longer) : 100000;
  for (const double friction : {0.0, 0.6}) {
    ContactBody body = make_contact_body(rough(friction), kRadiusM);
    add_modes(body, 0.3);
    CoupledStorage storage(make_plate(body, 4, 0.006, kRadiusM), free_of_clamps());
    CoupledState& state = storage.state();
    PoseWalk walk(body, 1, {.seed = 7});
    CoupledAccount account;
    std::int64_t together = 0;
    for (std::int64_t tick = 0; tick < ticks; ++tick) {
      const PortPoses& pose = walk.next();
      if (tick % 20 == 0) {
        send_all(state, body, pose);
      }
      together += account.step(state, pose).contacts > 1 ? 1 : 0;
    }
    EXPECT_EQ(state.safety.fault, Fault::kNone);
    EXPECT_GE(account.lowest_j, -1e-12);
    EXPECT_NEAR(imbalance_j(state.ledger), 0.0,
                1e-12 * std::sqrt(static_cast<double>(ticks) / 1e5));
    EXPECT_GT(together, ticks / 10);
    EXPECT_EQ(state.ledger.interventions, 0U);  // friction asks nothing of it
    EXPECT_EQ(state.model.field.equilibrium.scale, 1.0);
    if (friction > 0.0) {
      EXPECT_GT(account.net_j, 1e-5);
    }
  }
}

// Each contact slides with mu times the force that the others leave it.
TEST(CoupledModel, SlidingFrictionIsCoulombsOfEachContact) {
  BenchBodyOptions options;
  options.friction_min = options.friction_max = 0.4;
  const ContactBody body = make_contact_body(options, kRadiusM);
  CoupledStorage storage(make_plate(body, 4, 0.006, kRadiusM), free_of_clamps());
  CoupledState& state = storage.state();
  PortPoses pose;
  pose[0].position_m = {0.029, 0.0303, kRadiusM - 0.001};
  WrenchCommand command = press(state, body, pose);
  for (int tick = 0; tick < 2000; ++tick) {
    pose[0].position_m.x() += 1e-6;
    if (tick % 20 == 0) {
      send_all(state, body, pose);
    }
    command = step(state, {pose, 0}, kTickS);
  }
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d f = contact_place(state, i).force_n;
    EXPECT_NEAR(f.x(), -0.4 * f.z(), 1e-9) << i;
    EXPECT_GT(f.z(), 0.01);
  }
  EXPECT_GT(command.dissipated_j, 0.0);
}

// Elements that come late, half of them not at all.
TEST(CoupledModel, LateElementsGiveNoEnergy) {
  BenchBodyOptions options = rough(0.5);
  options.contrast = 100.0;
  const ContactBody body = make_contact_body(options, kRadiusM);
  CoupledStorage storage(make_plate(body, 4, 0.006, kRadiusM), free_of_clamps());
  CoupledState& state = storage.state();
  PoseWalk walk(body, 1, {.seed = 5});
  CoupledAccount account;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform;
  int starved = 0;
  for (int tick = 0; tick < 100000; ++tick) {
    const PortPoses& pose = walk.next();
    for (int i = 0; i < 4 && tick % 100 == 0; ++i) {
      if (uniform(random) < 0.3) {
        send(state, body, pose, i);
      }
    }
    starved += account.step(state, pose).starved ? 1 : 0;
  }
  EXPECT_EQ(state.safety.fault, Fault::kNone);
  EXPECT_GE(account.lowest_j, -1e-12);
  EXPECT_NEAR(imbalance_j(state.ledger), 0.0, 1e-12);
  EXPECT_GT(starved, 100);
}

}  // namespace
}  // namespace palpate
