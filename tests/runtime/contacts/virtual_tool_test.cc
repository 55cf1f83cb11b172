#include "runtime/contacts/virtual_tool.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

#include <gtest/gtest.h>

#include "tests/support/coupled_plate.h"

namespace palpate {
namespace {

// A plate or a pinch that hangs over a rough body.
class VirtualTools : public testing::Test {
 protected:
  void hold(const CoupledSet& set, const VirtualCoupling& coupling = {},
            const FastConfig& config = free_of_clamps()) {
    storage_ = std::make_unique<CoupledStorage>(set, config);
    virtual_tool_ = std::make_unique<VirtualTool>();
    ASSERT_EQ(couple(*virtual_tool_, state(), coupling), nullptr);
  }
  CoupledState& state() { return storage_->state(); }

  PortPoses tools() const {
    return {virtual_tool_->tool[0].pose(), virtual_tool_->tool[1].pose()};
  }

  // Over the body's middle, so much above where a lone contact would touch it.
  Vector3 over(double z_m) const {
    const double middle = 0.5 * body_.body.side_m();
    Vector3 at(middle, middle, 0.0);
    at.z() = kRadiusM + body_.body.height_m(at) + z_m;
    return at;
  }

  // A tick of the devices at `pose`, after what the slow process sends.
  WrenchCommand tick(const PortPoses& pose, double dt_s = kTickS) {
    if (ticks_++ % 20 == 0) {
      send_all(state(), body_, ticks_ == 1 ? pose : tools());
    }
    return step(*virtual_tool_, state(), {pose, 0}, dt_s);
  }

  // The whole account, to what rounding leaves of a sum of ticks.
  void expect_account(double to_j) {
    const PassivityLedger& t = virtual_tool_->total;
    EXPECT_NEAR(t.work_j, t.stored_j + t.tank_j + t.dent_j + t.left_j + t.dissipated_j,
                to_j);
  }

  ContactBody body_ = make_contact_body(rough(), kRadiusM);
  std::unique_ptr<CoupledStorage> storage_;
  std::unique_ptr<VirtualTool> virtual_tool_;
  int ticks_ = 0;
};

// Two seconds of random poses, also with ticks up to 50 ms late and a body that
// relaxes: no energy is made, by a plate of four and by two hands.
TEST_F(VirtualTools, MakeNoEnergy) {
  for (const int ports : {1, 2}) {
    for (const bool late : {false, true}) {
      BenchBodyOptions options = rough();
      if (late) {
        options.relaxing = {0.45, 0.35};
        options.relaxation_s = {0.06, 4.0};
      }
      body_ = make_contact_body(options, kRadiusM);
      ticks_ = 0;
      hold(ports == 1 ? make_plate(body_, 4, 0.006, kRadiusM)
                      : make_pinch(body_, kRadiusM));
      PoseWalk walk(body_, ports,
                    {.depth_m = 0.003, .apart_m = 0.008, .seed = ports + 4U});
      double lowest = 0.0;
      double dissipated = 0.0;
      int contacts = 0;
      int most = 0;
      for (int i = 0; i < 4000; ++i) {
        const WrenchCommand c = tick(walk.next(), late && i % 37 == 0 ? 0.05 : kTickS);
        ASSERT_EQ(c.fault, 0);
        lowest = std::min(lowest, virtual_tool_->total.work_j);
        EXPECT_GE(c.dissipated_j, dissipated - 1e-15);
        dissipated = c.dissipated_j;
        contacts += c.contacts > 1 ? 1 : 0;
        most = std::max(most, virtual_tool_->account.iterations_max);
      }
      EXPECT_GE(lowest, -1e-12);
      EXPECT_LT(virtual_tool_->account.residual_j, 1e-12);
      EXPECT_LT(virtual_tool_->account.taken_j, 1e-11);
      expect_account(1e-12);
      EXPECT_GT(contacts, 400);
      EXPECT_GT(virtual_tool_->total.work_j, 1e-4);
      EXPECT_LT(most, kVirtualIterationsMax);
    }
  }
}

// A body so stiff that the solver does not end: nobody gets what it leaves.
TEST_F(VirtualTools, WhatIsNotSolvedEndsInZeroForce) {
  BenchBodyOptions stiff = rough();
  stiff.force_n = 2e5;
  body_ = make_contact_body(stiff, kRadiusM);
  hold(make_plate(body_, 4, 0.006, kRadiusM));
  PortPoses pose;
  int stopped = 0;
  for (int i = 0; i < 1000; ++i) {
    pose[0].position_m = over(0.001 - 5e-6 * i);
    const WrenchCommand c = tick(pose, 0.002);
    if (c.fault != 0) {
      EXPECT_EQ(c.fault, static_cast<std::uint8_t>(Fault::kEnergy));
      EXPECT_EQ(c.wrench[0].force_n, Vector3::Zero());
      ++stopped;
    } else {
      expect_account(1e-8);
    }
  }
  EXPECT_GT(virtual_tool_->account.residual_j, 1e-9);
  EXPECT_GT(stopped, 0);
}

// Two readings of one place, in free air, half a microsecond apart: noise of 50 um.
TEST_F(VirtualTools, ReadingsAMicrosecondApartAreNoVelocity) {
  FastConfig config;
  config.model = LocalModel::kPotential;
  hold(make_plate(body_, 4, 0.006, kRadiusM), {}, config);
  double largest_n = 0.0;
  for (int i = 0; i < 200; ++i) {
    PortPoses pose;
    pose[0].position_m = over(0.02);
    ASSERT_EQ(tick(pose).fault, 0) << i;
    pose[0].position_m.x() += 5e-5;
    const WrenchCommand c = tick(pose, 5e-7);
    ASSERT_EQ(c.fault, 0) << i;
    largest_n = std::max(largest_n, c.wrench[0].force_n.norm());
  }
  EXPECT_LT(std::abs(virtual_tool_->total.work_j), 0.01);  // of going back, 0.1 m/s
  EXPECT_GT(largest_n, 0.0);
  expect_account(1e-12);
}

// A coupling without springs and dampers, clear of the body: thrown, it stays thrown.
TEST_F(VirtualTools, AFreeToolKeepsItsMomentum) {
  VirtualCoupling free;
  free.spring_n_per_m = free.spring_n_m_per_rad = 0.0;
  free.damper_n_s_per_m = free.damper_n_m_s = 0.0;
  hold(make_plate(body_, 4, 0.006, kRadiusM), free);
  PortPoses away;
  away[0].position_m = {0.05, 0.05, 0.05};
  (void)tick(away);
  VirtualBody& tool = virtual_tool_->tool[0];
  tool.velocity_m_per_s = {0.02, -0.01, 0.03};
  tool.momentum_n_m_s = {1e-5, 2e-5, -1e-5};
  const VirtualBody thrown = tool;
  virtual_tool_->total.work_j = kinetic_j(free, tool);  // by who threw it
  for (int i = 0; i < 2000; ++i) {
    const WrenchCommand c = tick(away);
    EXPECT_EQ(c.wrench[0].force_n, Vector3::Zero());
  }
  EXPECT_LT((tool.velocity_m_per_s - thrown.velocity_m_per_s).norm(), 1e-14);
  EXPECT_LT((tool.momentum_n_m_s - thrown.momentum_n_m_s).norm(), 1e-17);
  EXPECT_NEAR((tool.position_m - thrown.position_m - thrown.velocity_m_per_s).norm(),
              0.0, 1e-13);
  EXPECT_GT(Eigen::AngleAxisd(tool.turn).angle(), 0.1);
}

// Held still in a body far stiffer than the spring, the hand feels the spring, and no
// more; the tool rests where body and spring balance.
TEST_F(VirtualTools, AStuckHandFeelsTheSpring) {
  VirtualCoupling soft;
  soft.spring_n_per_m = 20.0;
  hold(make_plate(body_, 4, 0.006, kRadiusM), soft);
  const double push_m = 0.003;
  PortPoses pose;
  pose[0].position_m = over(0.002);
  (void)tick(pose);
  double touch_m = 0.0;
  for (int i = 0; i < 8000; ++i) {
    const double at = std::min(1.0, i / 4000.0);
    pose[0].position_m = over(0.002 - at * (0.002 + push_m));
    const WrenchCommand c = tick(pose);
    if (!c.in_contact) {
      touch_m = pose[0].position_m.z();
    }
  }
  const double felt = virtual_tool_->felt[0].force_n.z();
  const double stretch = virtual_tool_->tool[0].position_m.z() - pose[0].position_m.z();
  const Wrench body = wrenches(state().model, state().set, tools())[0];
  EXPECT_NEAR(felt, soft.spring_n_per_m * stretch, 1e-6 * felt);
  EXPECT_NEAR(felt, body.force_n.z(), 1e-4 * felt);
  EXPECT_LT(felt, soft.spring_n_per_m * (touch_m - pose[0].position_m.z()));
  EXPECT_GT(felt, 0.6 * soft.spring_n_per_m * push_m);
}

// Turned to and fro while it presses and lifts: where nothing pushes back against
// turns, the account's work is that of spring and damper on the way alone.
TEST_F(VirtualTools, TurnsThatAreNotFeltAreNoWork) {
  for (const bool felt : {false, true}) {
    ticks_ = 0;
    hold(make_plate(body_, 4, 0.006, kRadiusM));
    virtual_tool_->torque_felt = felt;
    const VirtualCoupling& c = virtual_tool_->coupling;
    PortPoses pose;
    double linear_j = 0.0;
    double lowest_j = 0.0;
    for (int i = 0; i < 3000; ++i) {
      const double phase = 2.0 * std::numbers::pi * i / 1000.0;
      const Vector3 before = pose[0].position_m;
      const Vector3 tool = virtual_tool_->tool[0].position_m;
      pose[0].position_m = over(-0.001 + 0.0015 * std::cos(phase));
      pose[0].rotation =
          Eigen::AngleAxisd(0.3 * std::sin(phase), Vector3::UnitY()).toRotationMatrix();
      ASSERT_EQ(tick(pose).fault, 0);
      const Vector3& now = pose[0].position_m;
      const Vector3 spring_n =
          c.spring_n_per_m * (now - virtual_tool_->tool[0].position_m);  // on the tool
      const Vector3 damper_n = -virtual_tool_->felt[0].force_n - spring_n;
      linear_j +=
          i == 0
              ? 0.0
              : 0.5 * c.spring_n_per_m *
                        ((tool - now).squaredNorm() - (tool - before).squaredNorm()) +
                    damper_n.dot(now - before);
      lowest_j = std::min(lowest_j, virtual_tool_->total.work_j);
    }
    expect_account(1e-12);
    EXPECT_GE(lowest_j, -1e-12);
    EXPECT_GT(std::abs(virtual_tool_->total.work_j), 1e-5);
    if (felt) {
      EXPECT_GT(std::abs(linear_j - virtual_tool_->total.work_j), 1e-6);
    } else {
      EXPECT_NEAR(linear_j, virtual_tool_->total.work_j, 1e-12);
    }
  }
}

TEST_F(VirtualTools, LimitsAndFaultsAreThoseOfTheHands) {
  FastConfig config = free_of_clamps();
  config.force_max_n = 0.05;
  hold(make_plate(body_, 4, 0.006, kRadiusM), {}, config);
  PortPoses pose;
  pose[0].position_m = over(0.002);
  double most = 0.0;
  for (int i = 0; i < 400; ++i) {
    pose[0].position_m.z() -= 1e-5;
    const WrenchCommand c = tick(pose);
    most = std::max(most, c.wrench[0].force_n.norm());
    ASSERT_EQ(c.fault, 0);
  }
  EXPECT_NEAR(most, 0.05, 1e-3);  // torques are small beside forces here
  EXPECT_GT(virtual_tool_->felt[0].force_n.norm(), 0.1);
  const WrenchCommand still = tick(pose, 0.0);
  EXPECT_EQ(still.fault, 0);
  pose[0].position_m.x() = std::nan("");
  const WrenchCommand bad = tick(pose);
  EXPECT_EQ(bad.fault, static_cast<std::uint8_t>(Fault::kNotFinite));
  EXPECT_EQ(bad.wrench[0].force_n, Vector3::Zero());
}

TEST_F(VirtualTools, RefuseOneContactAndWhatIsNotValid) {
  const auto held = std::make_unique<VirtualTool>();
  CoupledStorage alone(make_plate(body_, 1, 0.006, kRadiusM), free_of_clamps());
  EXPECT_NE(couple(*held, alone.state(), {}), nullptr);
  CoupledStorage four(make_plate(body_, 4, 0.006, kRadiusM), free_of_clamps());
  VirtualCoupling light;
  light.mass_kg = 0.0;
  const char* const why = couple(*held, four.state(), light);
  ASSERT_NE(why, nullptr);
  EXPECT_NE(std::strstr(why, "mass"), nullptr);
  light.mass_kg = 0.01;  // 3 g for 1500 N/m at 2 ms, 12 g more for 6 N s/m
  const char* const too_light = couple(*held, four.state(), light);
  ASSERT_NE(too_light, nullptr);
  EXPECT_NE(std::strstr(too_light, "too light"), nullptr);
  EXPECT_LT(four.state().config.force_max_n, 1e300);
}

}  // namespace
}  // namespace palpate
