#include "runtime/contacts/virtual_coupling.h"

#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "runtime/slow/coupled_storage.h"
#include "tests/bench/runtime/contact_walk.h"
#include "tests/support/tick.h"

namespace palpate {
namespace {

Real nothing(void* /*of*/, const PortPose& /*pose*/, Wrench* /*wrench*/) {
  return 0.0;
}

// A wall z = 0 that a handle's two ends, 3 cm from its middle along x, are pressed on:
// stiff, and not smooth.
Real wall(void* of, const PortPose& pose, Wrench* wrench) {
  const double stiffness = *static_cast<const double*>(of);
  double energy = 0.0;
  for (const double side : {-0.03, 0.03}) {
    const Vector3 arm = pose.rotation.col(0) * side;
    const double depth = std::max(0.0, -(pose.position_m + arm).z());
    energy += stiffness * std::pow(depth, 2.5) / 2.5;
    if (wrench != nullptr) {
      const Vector3 force(0.0, 0.0, stiffness * std::pow(depth, 1.5));
      wrench->force_n += force;
      wrench->torque_n_m += arm.cross(force);
    }
  }
  return energy;
}

// 10^6 ticks of a body that tumbles freely: nothing is lost.
TEST(VirtualCoupling, AFreeBodyKeepsMomentumAndEnergy) {
  VirtualCoupling coupling;
  coupling.inertia_kg_m2 = {1e-5, 2e-5, 4e-5};
  coupling.spring_n_per_m = coupling.spring_n_m_per_rad = 0.0;
  coupling.damper_n_s_per_m = coupling.damper_n_m_s = 0.0;
  VirtualBody body;
  body.velocity_m_per_s = {0.3, -0.2, 0.1};
  body.momentum_n_m_s = {1e-4, 2e-4, -1e-4};
  const Vector3 velocity = body.velocity_m_per_s;
  const Vector3 momentum = body.momentum_n_m_s;
  const double energy = kinetic_j(coupling, body);
  double worst = 0.0;
  for (int tick = 0; tick < 1000000; ++tick) {
    const VirtualTick made =
        advance(coupling, body, {}, {}, {nullptr, &nothing}, kTickS);
    ASSERT_LT(made.iterations, kVirtualIterationsMax);
    worst = std::max(worst, std::abs(kinetic_j(coupling, body) - energy));
  }
  EXPECT_EQ(body.momentum_n_m_s, momentum);
  EXPECT_NEAR((body.velocity_m_per_s - velocity).norm(), 0.0, 1e-13);
  EXPECT_LT(worst, 1e-13 * std::max(1.0, energy));
  EXPECT_NEAR(body.turn.norm(), 1.0, 1e-15);
}

// It tumbles: the axis of middle inertia is not stable.
TEST(VirtualCoupling, AFreeBodyTumbles) {
  VirtualCoupling coupling;
  coupling.inertia_kg_m2 = {1e-5, 2e-5, 4e-5};
  coupling.spring_n_per_m = coupling.spring_n_m_per_rad = 0.0;
  coupling.damper_n_s_per_m = coupling.damper_n_m_s = 0.0;
  VirtualBody body;
  body.momentum_n_m_s = {1e-7, 2e-4, 0.0};
  double lowest = 1.0;
  for (int tick = 0; tick < 10000; ++tick) {
    (void)advance(coupling, body, {}, {}, {nullptr, &nothing}, kTickS);
    const Vector3 in_tool = body.turn.conjugate() * body.momentum_n_m_s;
    lowest = std::min(lowest, in_tool.normalized().y());
  }
  EXPECT_LT(lowest, -0.9);
}

// Work = change + dissipated, tick by tick, on a wall of any stiffness; what comes back
// is never more than was put in.
TEST(VirtualCoupling, EnergyIsAccountedForTickByTick) {
  for (double stiffness : {1e3, 1e5, 1e6}) {
    const VirtualCoupling coupling;
    VirtualBody body;
    body.position_m = {0.0, 0.0, 0.002};
    DevicePose device{.position_m = body.position_m};
    const double start = kinetic_j(coupling, body) + spring_j(coupling, body, device);
    double work = 0.0;
    double dissipated = 0.0;
    double worst = 0.0;
    double lowest = 0.0;
    double stored = start;
    for (int tick = 0; tick < 40000; ++tick) {
      const double t = tick * kTickS;
      const DevicePose before = device;
      device.position_m = {0.01 * std::sin(t), 0.0, 0.002 + 0.004 * std::sin(9.0 * t)};
      device.turn = Eigen::AngleAxisd(0.1 * std::sin(5.0 * t), Vector3::UnitY());
      device.velocity_m_per_s = (device.position_m - before.position_m) / kTickS;
      const Eigen::AngleAxisd turned(device.turn * before.turn.conjugate());
      device.spin_rad_per_s = turned.angle() / kTickS * turned.axis();
      const VirtualTick made =
          advance(coupling, body, before, device, {&stiffness, &wall}, kTickS);
      work += made.work_j;
      dissipated += made.dissipated_j;
      worst = std::max(worst, std::abs(made.residual_j));
      lowest = std::min(lowest, work);
      EXPECT_GE(made.dissipated_j, 0.0);
      stored = kinetic_j(coupling, body) + spring_j(coupling, body, device) +
               made.potential_j;
    }
    EXPECT_LT(worst, 1e-12) << stiffness;
    EXPECT_NEAR(work, stored - start + dissipated, 4e-11) << stiffness;
    EXPECT_GE(lowest, -1e-12);
    EXPECT_GT(work, 1e-4);
  }
}

// On a plate of coupled contacts: the body that the fast step renders is the potential.
struct RenderedPort {
  CoupledState* state;
  CoupledModel* moved;

  static Real energy(void* of, const PortPose& pose, Wrench* wrench) {
    auto& self = *static_cast<RenderedPort*>(of);
    const PortPoses poses{pose, PortPose{}};
    const Real energy = potential_j(*self.state, *self.moved, poses);
    if (wrench != nullptr) {
      *wrench = wrenches(*self.moved, self.state->set, poses)[0];
    }
    return energy;
  }
};

TEST(VirtualCoupling, CarriesAPlateOfContacts) {
  const ContactBody body = make_contact_body({.wave_m = 0.001, .contrast = 9.0}, 0.003);
  FastConfig config;
  config.model = LocalModel::kPotential;
  config.force_max_n = 1e9;
  config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
  CoupledStorage storage(make_plate(body, 4, 0.006, 0.003), config);
  CoupledState& state = storage.state();
  const auto moved = std::make_unique<CoupledModel>();
  RenderedPort rendered{&state, moved.get()};
  const VirtualCoupling coupling;
  PoseWalk walk(body, 1, {.depth_m = 0.003, .seed = 4});
  VirtualBody tool;
  DevicePose device;
  double work = 0.0;
  double lowest = 0.0;
  double worst = 0.0;
  double dissipated = 0.0;
  double stored = 0.0;
  int contacts = 0;
  for (int tick = 0; tick < 10000; ++tick) {
    const PortPoses& aim = walk.next();
    const DevicePose before = device;
    device.position_m = aim[0].position_m;
    device.turn = Eigen::Quaterniond(aim[0].rotation);
    if (tick == 0) {
      tool.position_m = device.position_m;
      tool.turn = device.turn;
      send(state, body, aim, 0);
      continue;
    }
    device.velocity_m_per_s = (device.position_m - before.position_m) / kTickS;
    const Eigen::AngleAxisd turned(device.turn * before.turn.conjugate());
    device.spin_rad_per_s = turned.angle() / kTickS * turned.axis();
    PortPoses pose{tool.pose(), PortPose{}};
    for (int i = 0; i < 4 && tick % 20 == 1; ++i) {
      send(state, body, pose, i);
    }
    const VirtualTick made = advance(coupling, tool, before, device,
                                     {&rendered, &RenderedPort::energy}, kTickS);
    pose[0] = tool.pose();
    contacts += step(state, {pose, 0}, kTickS).contacts > 1 ? 1 : 0;
    work += made.work_j;
    dissipated += made.dissipated_j;
    worst = std::max(worst, std::abs(made.residual_j));
    lowest = std::min(lowest, work);
    stored = kinetic_j(coupling, tool) + spring_j(coupling, tool, device) +
             state.ledger.work_j;
  }
  EXPECT_EQ(state.safety.fault, Fault::kNone);
  EXPECT_GT(contacts, 1000);
  EXPECT_LT(worst, 1e-12);
  EXPECT_NEAR(work, stored + dissipated, 1e-11);
  EXPECT_GE(lowest, -1e-12);
}

TEST(VirtualCoupling, IsChecked) {
  VirtualCoupling coupling;
  EXPECT_EQ(check(coupling), nullptr);
  coupling.mass_kg = 0.0;
  EXPECT_NE(check(coupling), nullptr);
  coupling = {};
  coupling.damper_n_m_s = -1.0;
  EXPECT_NE(check(coupling), nullptr);
  coupling = {};
  coupling.lever_m = std::nan("");
  EXPECT_NE(check(coupling), nullptr);
}

}  // namespace
}  // namespace palpate
