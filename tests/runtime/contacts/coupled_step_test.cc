#include "runtime/contacts/coupled_step.h"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/coupled_plate.h"

namespace palpate {
namespace {

TEST(CoupledStep, WrenchIsTheGradientOfThePotential) {
  ContactBody body = make_contact_body(rough(), kRadiusM);
  add_modes(body, 0.3);
  for (const int contacts : {2, 4, 16}) {
    const CoupledSet set = make_plate(body, contacts, 0.006, kRadiusM);
    CoupledStorage storage(set, free_of_clamps());
    CoupledState& state = storage.state();
    PoseWalk walk(body, 1, {.seed = 3});
    int tried = 0;
    for (int tick = 0; tick < 20000; ++tick) {
      const PortPoses& pose = walk.next();
      if (tick % 20 == 0) {
        send_all(state, body, pose);
      }
      const WrenchCommand command = step(state, {pose, 0}, kTickS);
      if (tick % 197 == 5 && command.contacts > 1) {
        expect_gradient(state, pose, command, set.lever_m[0]);
        ++tried;
      }
    }
    EXPECT_GT(tried, 5) << contacts;
    EXPECT_EQ(state.safety.fault, Fault::kNone);
  }
}

TEST(CoupledStep, TwoHandsFeelOnePotential) {
  ContactBody body = make_contact_body(rough(), kRadiusM);
  add_modes(body, 0.3);
  CoupledStorage storage(make_pinch(body, kRadiusM), free_of_clamps());
  CoupledState& state = storage.state();
  PoseWalk walk(body, 2, {.reach_m = 0.004, .apart_m = 0.009, .seed = 2});
  int tried = 0;
  for (int tick = 0; tick < 30000; ++tick) {
    const PortPoses& pose = walk.next();
    if (tick % 20 == 0) {
      send_all(state, body, pose);
    }
    const WrenchCommand command = step(state, {pose, 0}, kTickS);
    // Just touched, the force bends too much for differences over 2e-7 m.
    const double least =
        std::min(command.wrench[0].force_n.norm(), command.wrench[1].force_n.norm());
    if (tick % 197 == 5 && least > 1e-3) {
      expect_gradient(state, pose, command, kRadiusM);
      ++tried;
    }
  }
  EXPECT_GT(tried, 3);
}

TEST(CoupledStep, OneContactIsTodaysStepBitForBit) {
  const ContactBody body = make_contact_body(rough(0.5), kRadiusM);
  CoupledSet set = make_plate(body, 1, 0.006, kRadiusM);
  set.sphere[0].centre_m = {0.001, 0.002, -0.004};
  ASSERT_EQ(finish(set), nullptr);
  CoupledStorage storage(set, free_of_clamps());
  CoupledState& state = storage.state();
  const auto single = std::make_unique<FastState>();
  single->config = free_of_clamps();
  single->config.tool_radius_m = kRadiusM;
  PoseWalk walk(body, 1, {.seed = 6});
  int contacts = 0;
  for (int tick = 0; tick < 20000; ++tick) {
    const PortPoses& pose = walk.next();
    const Eigen::Vector3d x = centre_of(set, pose, 0);
    if (tick % 20 == 0) {
      send(state, body, pose, 0);
      for (const Element& element : body.body.around(x)) {
        accept(*single, element);
      }
    }
    const WrenchCommand command = step(state, {pose, 0}, kTickS);
    const FastCommand wanted = step(*single, {x, 0}, kTickS);
    ASSERT_EQ(command.wrench[0].force_n, wanted.force_n) << tick;
    ASSERT_EQ(command.stored_j, wanted.stored_j);
    ASSERT_EQ(command.wrench[0].torque_n_m,
              (x - pose[0].position_m).cross(wanted.force_n));
    contacts += command.in_contact ? 1 : 0;
  }
  EXPECT_GT(contacts, 2000);
}

// Contacts without compliance between them are single ones, added up.
TEST(CoupledStep, WithoutComplianceForcesAdd) {
  ContactBody body = make_contact_body(rough(), kRadiusM);
  for (ContactRow& row : body.row) {
    row.value.fill(0.0F);
  }
  const CoupledSet set = make_plate(body, 4, 0.006, kRadiusM);
  CoupledStorage storage(set, free_of_clamps());
  std::array<std::unique_ptr<FastState>, 4> single;
  for (auto& one : single) {
    one = std::make_unique<FastState>();
    one->config = free_of_clamps();
    one->config.tool_radius_m = kRadiusM;
  }
  PoseWalk walk(body, 1, {.seed = 6});
  double largest = 0.0;
  for (int tick = 0; tick < 20000; ++tick) {
    const PortPoses& pose = walk.next();
    if (tick % 20 == 0) {
      send_all(storage.state(), body, pose);
    }
    const WrenchCommand command = step(storage.state(), {pose, 0}, kTickS);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector3d x = centre_of(set, pose, i);
      FastState& one = *single[static_cast<std::size_t>(i)];
      for (const Element& element : body.body.around(x)) {
        if (tick % 20 == 0) {
          accept(one, element);
        }
      }
      sum += step(one, {x, 0}, kTickS).force_n;
    }
    ASSERT_NEAR((command.wrench[0].force_n - sum).norm(), 0.0, 1e-10) << tick;
    largest = std::max(largest, sum.norm());
  }
  EXPECT_GT(largest, 0.1);
}

TEST(CoupledStep, CouplingMakesThePlateSofter) {
  const ContactBody body = make_contact_body({}, kRadiusM, 1e3);
  const CoupledSet set = make_plate(body, 4, 0.006, kRadiusM);
  CoupledStorage storage(set, free_of_clamps());
  PortPoses pose;
  pose[0].position_m = {0.03, 0.03, kRadiusM - 0.001};
  const WrenchCommand command = press(storage.state(), body, pose);
  const double alone = body.body.element[0].node[0].curve().at(0.001).force_n;
  // Hertz coupled by point loads at s = 6 mm and its diagonal, a^2 = R d.
  const double a = std::sqrt(kRadiusM * 0.001);
  const double sum = (2.0 + 1.0 / std::sqrt(2.0)) / 0.006;
  double delta = 0.001;
  for (int i = 0; i < 200; ++i) {
    delta =
        0.5 * delta + 0.5 * (0.001 - 4.0 / (3.0 * std::numbers::pi) * sum *
                                         std::sqrt(kRadiusM) * std::pow(delta, 1.5));
  }
  EXPECT_NEAR(command.wrench[0].force_n.z() / (4.0 * alone),
              std::pow(delta / 0.001, 1.5), 1e-3);  // samples of a stored curve
  EXPECT_LT(delta, 0.001 - 0.1 * a * 0.001 / 0.006);
  EXPECT_NEAR(command.wrench[0].torque_n_m.norm(), 0.0, 1e-12);
  EXPECT_EQ(command.contacts, 4);
}

// Modes alone: the bulge that subtracts pulls the others' surface up, the tilt that
// adds sinks it; C_ij = s b_i b_j to the last digits of the stored floats.
TEST(CoupledStep, ModesCoupleWhateverTheDistance) {
  ContactBody body = make_contact_body({}, kRadiusM);
  add_modes(body, 0.3);
  for (ContactRow& row : body.row) {
    row.value.fill(0.0F);
    row.mode = {2e-2F, 1e-2F};
  }
  CoupledStorage storage(make_plate(body, 2, 0.006, kRadiusM), free_of_clamps());
  PortPoses pose;
  pose[0].position_m = {0.03, 0.03, kRadiusM - 0.001};
  const WrenchCommand command = press(storage.state(), body, pose);
  const double f = 0.5 * command.wrench[0].force_n.z();
  const auto curve = body.body.element[0].node[0].curve();
  EXPECT_NEAR(curve.at(0.001 - (4e-4 - 1e-4) * f).force_n, f, 1e-8);
  EXPECT_GT(f, 0.01);
}

TEST(CoupledStep, OddNumbersAreFaults) {
  const ContactBody body = make_contact_body(rough(), kRadiusM);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto fresh = [&] {
    return CoupledStorage(make_plate(body, 4, 0.006, kRadiusM), free_of_clamps());
  };
  PortPoses pose;
  pose[0].position_m = {0.03, 0.03, 0.002};
  {
    CoupledStorage storage = fresh();
    PortPoses odd = pose;
    odd[0].position_m.x() = nan;
    const WrenchCommand command = step(storage.state(), {odd, 0}, kTickS);
    EXPECT_EQ(command.fault, static_cast<int>(Fault::kNotFinite));
    EXPECT_EQ(command.wrench[0].force_n.norm(), 0.0);
  }
  {
    CoupledStorage storage = fresh();
    PortPoses odd = pose;
    odd[0].rotation *= 1.1;
    EXPECT_EQ(step(storage.state(), {odd, 0}, kTickS).fault,
              static_cast<int>(Fault::kNotFinite));
  }
  {
    CoupledStorage storage = fresh();
    EXPECT_EQ(step(storage.state(), {pose, 0}, 1.5).fault,
              static_cast<int>(Fault::kTimeStep));
  }
  {
    CoupledStorage storage = fresh();
    ContactElement message;
    message.element = body.body.element[0];
    message.element.node[1].force_n[3] = nan;
    accept(storage.state(), message);
    EXPECT_EQ(step(storage.state(), {pose, 0}, kTickS).fault,
              static_cast<int>(Fault::kNotFinite));
  }
}

// The limits hold for force and torque together.
// Turned while it presses, turned back while it is lifted, by a device that cannot push
// against turns: as work of a potential that gives the hand energy in the axes that it
// feels; carried along, nothing.
TEST(CoupledStep, TurnsThatAreCarriedGiveNothing) {
  const ContactBody body = make_contact_body(rough(), kRadiusM);
  for (const bool carried : {false, true}) {
    CoupledStorage storage(make_plate(body, 4, 0.006, kRadiusM), free_of_clamps());
    CoupledState& state = storage.state();
    const double middle = 0.5 * body.body.side_m();
    PortPoses pose;
    Vector3 force = Vector3::Zero();
    double felt_j = 0.0;
    double most_j = 0.0;
    double lowest_j = 0.0;
    for (int i = 0; i < 4000; ++i) {
      const double phase = 2.0 * std::numbers::pi * i / 1000.0;
      PortPoses next = pose;
      next[0].rotation =
          Eigen::AngleAxisd(0.3 * std::sin(phase), Vector3::UnitY()).toRotationMatrix();
      if (i % 20 == 0) {
        send_all(state, body, next);
      }
      if (carried) {
        carry(state, next);
      }
      next[0].position_m = {middle, middle, kRadiusM + 0.002 * std::cos(phase)};
      const WrenchCommand c = step(state, {next, 0}, kTickS);
      ASSERT_EQ(c.fault, 0);
      felt_j -=
          0.5 *
          (force + c.wrench[0].force_n).dot(next[0].position_m - pose[0].position_m) *
          (i > 0 ? 1.0 : 0.0);
      force = c.wrench[0].force_n;
      pose = next;
      most_j = std::max(most_j, felt_j);
      lowest_j = std::min(lowest_j, felt_j);
    }
    EXPECT_GT(most_j, 1e-5);
    EXPECT_NEAR(state.ledger.work_j,
                state.ledger.stored_j + state.ledger.tank_j + state.ledger.dissipated_j,
                1e-12);
    if (carried) {
      // The mean of two forces misses the steps that a turn makes in them.
      EXPECT_NEAR(felt_j, state.ledger.work_j, 0.05 * most_j);
      EXPECT_GT(lowest_j, -0.02 * most_j);
    } else {
      EXPECT_LT(lowest_j, -0.2 * most_j);
    }
  }
}

TEST(CoupledStep, WrenchesAreClampedWhole) {
  const ContactBody body = make_contact_body(rough(), kRadiusM);
  const CoupledSet set = make_plate(body, 4, 0.006, kRadiusM);
  FastConfig config = free_of_clamps();
  config.force_max_n = 0.05;
  CoupledStorage clamped(set, config);
  CoupledStorage whole(set, free_of_clamps());
  PortPoses pose;
  pose[0].position_m = {0.03, 0.03, 0.001};
  const Wrench a = press(clamped.state(), body, pose).wrench[0];
  const Wrench b = press(whole.state(), body, pose).wrench[0];
  const double lever = set.lever_m[0];
  EXPECT_GT(b.force_n.norm(), 0.1);
  EXPECT_NEAR(std::hypot(a.force_n.norm(), a.torque_n_m.norm() / lever), 0.05, 1e-12);
  EXPECT_NEAR(a.force_n.cross(b.force_n).norm(), 0.0, 1e-12);
  EXPECT_NEAR(a.torque_n_m.cross(b.torque_n_m).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace palpate
