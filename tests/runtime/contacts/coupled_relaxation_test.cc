// Several contacts on a body that remembers: against a convolution of the coupled
// problem, against the response of one contact, as a potential, and on walks.
#include "runtime/contacts/coupled_relaxation.h"

#include <cmath>
#include <cstdlib>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/coupled_plate.h"

namespace palpate {
namespace {

// The stress test of one contact's walks: one time is short.
const std::vector<double> kRelaxing{0.45, 0.35};
const std::vector<double> kTimesS{0.06, 4.0};

BenchBodyOptions relaxing(BenchBodyOptions options, int bundles = 1) {
  options.relaxing = kRelaxing;
  options.relaxation_s = kTimesS;
  options.bundles = bundles;
  return options;
}

// Cuts of bundles lie at 1.5 and 4.4 mm of three, so deep that some are passed.
double depth_of(int bundles) {
  return bundles > 1 ? 0.004 : 0.0015;
}

// Three pads that lie as they please, on a wavy body of unlike curves: what each bears
// falls by one factor, that of the scalar law, as the body relaxes alike everywhere.
TEST(CoupledRelaxation, HeldProbeRelaxesAsTheScalarLawSays) {
  ContactBody body = make_contact_body(relaxing(rough()), kRadiusM);
  add_modes(body, 0.3);
  CoupledStorage storage(make_plate(body, 3, 0.006, kRadiusM), free_of_clamps());
  CoupledState& state = storage.state();
  PortPoses pose;
  pose[0].position_m = {0.0301, 0.0303, kRadiusM + 0.004};
  send_all(state, body, pose);
  (void)step(state, {pose, 0}, 0.0);
  pose[0].position_m.z() = kRadiusM - 0.002;
  const WrenchCommand sudden = step(state, {pose, 0}, 0.0);
  ASSERT_EQ(sudden.contacts, 3);
  Eigen::Array3d first;
  for (int i = 0; i < 3; ++i) {
    first(i) = state.model.field.equilibrium.force_n(i);
  }
  double time_s = 0.0;
  for (int tick = 1; tick <= 4000; ++tick) {
    const double dt_s = tick == 2000 ? 1.0 : kTickS;  // one comes late
    (void)step(state, {pose, 0}, dt_s);
    time_s += dt_s;
    if (tick % 500 != 0) {
      continue;
    }
    const double spent_s = time_s - state.model.relaxing.gathered_s;
    double factor = 1.0;
    for (std::size_t k = 0; k < kTimesS.size(); ++k) {
      factor -= kRelaxing[k] * (1.0 - std::exp(-spent_s / kTimesS[k]));
    }
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(state.model.field.equilibrium.force_n(i) / first(i), factor, 1e-9)
          << "contact " << i << " after " << time_s << " s";
    }
  }
  EXPECT_EQ(state.model.relaxing.shortened, 0U);
}

// Contacts at fixed places over a plane, each moved up and down by itself; f = a d^2,
// so that its samples' cubics are the curve.
constexpr double kCurve = 2.0 / (0.008 * 0.008);

double depth_m(int port, double t) {
  return port == 0 ? 0.0012 + 0.0020 * std::sin(2.0 * M_PI * 1.5 * t)
                   : 0.0010 + 0.0012 * std::sin(2.0 * M_PI * 2.3 * t + 1.0);
}

// The hereditary integral over all of the past, trapezoids at 20 kHz; the coupled
// unilateral problem by relaxation of each contact in turn.
class Convolution {
 public:
  Convolution(const std::vector<int>& port, const Eigen::MatrixXd& compliance)
      : port_(port), compliance_(compliance), past_(kTimesS.size()) {
    for (auto& sum : past_) {
      sum = Eigen::VectorXd::Zero(compliance.rows());
    }
    stress_ = Eigen::VectorXd::Zero(compliance.rows());
  }

  static constexpr double kStepS = 5e-5;

  // What the contacts bear at the next time.
  Eigen::VectorXd next() {
    const Eigen::VectorXd before = stress_;
    time_s_ += kStepS;
    // Of the integral, what the new stress itself adds is in `own`.
    Eigen::VectorXd carried = Eigen::VectorXd::Zero(stress_.size());
    double own = 0.0;
    for (std::size_t k = 0; k < kTimesS.size(); ++k) {
      const double x = kStepS / kTimesS[k];
      past_[k] = std::exp(-x) * (past_[k] + 0.5 * x * before);
      carried += kRelaxing[k] * past_[k];
      own += kRelaxing[k] * 0.5 * x;
    }
    for (int sweep = 0; sweep < 200; ++sweep) {
      for (Eigen::Index i = 0; i < stress_.size(); ++i) {
        // delta(p) = d - sum_j C_ij p_j where it bears something, p - s = 0 elsewhere.
        const double left = depth_m(port_[static_cast<std::size_t>(i)], time_s_) -
                            compliance_.row(i).dot(stress_);
        const double pressed = left > 0.0 ? kCurve * left * left : 0.0;
        stress_(i) = std::max(pressed, carried(i) / (1.0 - own));
      }
    }
    for (std::size_t k = 0; k < kTimesS.size(); ++k) {
      past_[k] += 0.5 * kStepS / kTimesS[k] * stress_;
    }
    return stress_ - (carried + own * stress_);
  }

 private:
  std::vector<int> port_;
  Eigen::MatrixXd compliance_;
  std::vector<Eigen::VectorXd> past_;
  Eigen::VectorXd stress_;
  double time_s_ = 0.0;
};

// Two contacts in one hand, one in another.
CoupledSet two_and_one(const ContactBody& body) {
  CoupledSet set = make_plate(body, 2, 0.008, kRadiusM);
  set.count = 3;
  set.ports = 2;
  set.sphere[2].radius_m = kRadiusM;
  set.sphere[2].port = 1;
  (void)finish(set);
  return set;
}

TEST(CoupledRelaxation, IsTheConvolutionOfTheCoupledProblem) {
  BenchBodyOptions options = relaxing({});
  options.exponent = 2.0;
  const ContactBody body = make_contact_body(options, kRadiusM);
  CoupledStorage storage(two_and_one(body), free_of_clamps());
  CoupledState& state = storage.state();
  const auto pose_at = [&](double t) {
    PortPoses pose;
    pose[0].position_m = {0.0301, 0.0303, kRadiusM - depth_m(0, t)};
    pose[1].position_m = {0.0301, 0.0373, kRadiusM - depth_m(1, t)};
    return pose;
  };
  send_all(state, body, pose_at(0.0));
  (void)step(state, {pose_at(-0.2), 0}, 0.0);
  Eigen::MatrixXd compliance =
      state.model.field.equilibrium.compliance_m_per_n.topLeftCorner(3, 3);
  ASSERT_GT(compliance(0, 2), 0.0);
  Convolution reference({0, 0, 1}, compliance);
  double error = 0.0;
  double size = 0.0;
  int lost = 0;
  const int ticks = 3000;
  for (int tick = 1; tick <= ticks; ++tick) {
    Eigen::VectorXd wanted;
    for (int i = 0; i < 10; ++i) {
      wanted = reference.next();
    }
    (void)step(state, {pose_at(tick * kTickS), 0}, kTickS);
    const Eigen::VectorXd given =
        state.model.field.equilibrium.force_n.head(3).matrix();
    error += (given - wanted).squaredNorm();
    size += wanted.squaredNorm();
    lost += (given.array() > 0.0).all() ? 0 : 1;
  }
  EXPECT_GT(lost, ticks / 10);
  EXPECT_LT(lost, ticks * 9 / 10);
  EXPECT_LT(std::sqrt(error / size), 1e-3);
  EXPECT_EQ(state.model.field.equilibrium.scale, 1.0);
}

// The second contact never touches: the first is the one of fast_step.h.
TEST(CoupledRelaxation, AContactThatTouchesAloneIsThatOfOneContact) {
  for (const int bundles : {1, 4}) {
    const ContactBody body = make_contact_body(relaxing(rough(), bundles), kRadiusM);
    CoupledSet set = make_plate(body, 2, 0.008, kRadiusM);
    set.sphere[1].centre_m.z() = 0.008;
    CoupledStorage storage(set, free_of_clamps());
    CoupledState& state = storage.state();
    const auto one = std::make_unique<FastState>();
    one->config = free_of_clamps();
    one->config.tool_radius_m = kRadiusM;
    PoseWalk walk(
        body, 1,
        {.depth_m = depth_of(bundles), .tilt_rad = 0.0, .turn_rad = 0.0, .seed = 11});
    double most_n = 0.0;
    for (int tick = 0; tick < 20000; ++tick) {
      const PortPoses& pose = walk.next();
      const Vector3 centre = centre_of(set, pose, 0);
      if (tick % 20 == 0) {
        send_all(state, body, pose);
        for (const Element& element : body.body.around(centre)) {
          accept(*one, element);
        }
      }
      const Vector3 given = step(state, {pose, 0}, kTickS).wrench[0].force_n;
      const Vector3 wanted = step(*one, {centre, 0}, kTickS).force_n;
      most_n = std::max(most_n, wanted.norm());
      // In the air one contact's dents go back at once when it comes down again, and
      // are forgotten below kForgottenN a little earlier or later.
      ASSERT_NEAR((given - wanted).norm(), 0.0, kForgottenN) << tick;
    }
    EXPECT_GT(most_n, 0.02);
    // What dents hold in the air is estimated there, and left behind here.
    EXPECT_NEAR(state.ledger.dissipated_j, one->ledger.dissipated_j,
                0.05 * one->ledger.dissipated_j);
  }
}

TEST(CoupledRelaxation, WrenchIsTheGradientAtFrozenMemory) {
  for (const int bundles : {1, 3}) {
    ContactBody body = make_contact_body(relaxing(rough(), bundles), kRadiusM);
    add_modes(body, 0.3);
    for (const int ports : {1, 2}) {
      const CoupledSet set = ports == 1 ? make_plate(body, 4, 0.006, kRadiusM)
                                        : make_pinch(body, kRadiusM);
      CoupledStorage storage(set, free_of_clamps());
      CoupledState& state = storage.state();
      PoseWalk walk(body, ports,
                    {.depth_m = depth_of(bundles),
                     .apart_m = ports == 1 ? 0.0 : 0.008,
                     .seed = 3});
      int tried = 0;
      int lifted = 0;
      for (int tick = 0; tick < 12000; ++tick) {
        const PortPoses& pose = walk.next();
        if (tick % 20 == 0) {
          send_all(state, body, pose);
        }
        const WrenchCommand command = step(state, {pose, 0}, kTickS);
        if (tick % 97 == 5 && command.contacts > 0) {
          expect_gradient(state, pose, command, set.lever_m[0]);
          ++tried;
          lifted += command.contacts < set.count && command.carried_n > 0.0 ? 1 : 0;
        }
      }
      EXPECT_GT(tried, 20);
      EXPECT_GT(lifted, 3);  // contacts over their dents among them
    }
  }
}

// 1.5 x 10^4 ticks; PALPATE_LONG_WALK=10000000 for the capability's. Ticks of uneven
// length, some of them a second late.
TEST(CoupledRelaxation, PoseWalksNeverGetEnergy) {
  const char* longer = std::getenv("PALPATE_LONG_WALK");
  const std::int64_t ticks = longer != nullptr ? std::atoll(longer) : 15000;
  for (const int bundles : {1, 3}) {
    for (const int ports : {1, 2}) {
      BenchBodyOptions options = relaxing(rough(0.4), bundles);
      options.contrast = 30.0;
      ContactBody body = make_contact_body(options, kRadiusM);
      add_modes(body, 0.3);
      CoupledStorage storage(ports == 1 ? make_plate(body, 4, 0.006, kRadiusM)
                                        : make_pinch(body, kRadiusM),
                             free_of_clamps());
      CoupledState& state = storage.state();
      PoseWalk walk(body, ports,
                    {.depth_m = depth_of(bundles),
                     .apart_m = ports == 1 ? 0.0 : 0.008,
                     .seed = 7});
      CoupledAccount account;
      std::mt19937_64 random(2);
      std::uniform_real_distribution<double> uniform;
      std::int64_t relaxed = 0;
      double drift_j = 0.0;
      for (std::int64_t tick = 0; tick < ticks; ++tick) {
        const PortPoses& pose = walk.next();
        for (int i = 0; i < state.set.count && tick % 20 == 0; ++i) {
          if (uniform(random) < 0.8) {
            send(state, body, pose, i);
          }
        }
        const double late_s = uniform(random) < 1e-3 ? uniform(random) : 0.0;
        const double dt_s = kTickS * (0.2 + 1.6 * uniform(random)) + late_s;
        relaxed += account.step(state, pose, std::min(1.0, dt_s)).carried_n > 0.01;
        drift_j = std::max(drift_j, std::abs(imbalance_j(state.ledger)));
      }
      EXPECT_EQ(state.safety.fault, Fault::kNone);
      EXPECT_GE(account.lowest_j, -1e-12);
      EXPECT_LE(drift_j, 1e-12 * std::sqrt(static_cast<double>(ticks) / 1e4));
      EXPECT_LE(state.ledger.created_j, 1e-15 * static_cast<double>(ticks) / 1e3);
      EXPECT_GT(relaxed, ticks / 10);
      EXPECT_GT(account.net_j, 1e-5);
      EXPECT_LT(state.model.relaxing.shortened, 2e-3 * static_cast<double>(ticks));
      EXPECT_EQ(state.model.field.equilibrium.scale, 1.0);
    }
  }
}

// Two fingers above the plate, 6 mm apart.
PortPoses side_by_side() {
  PortPoses pose;
  pose[0].position_m = {0.0301, 0.0303, kRadiusM + 0.001};
  pose[1].position_m = {0.0361, 0.0303, kRadiusM + 0.001};
  return pose;
}

// A finger that is lifted leaves its dent, which sinks the other one by less and less;
// while nothing presses, nothing is felt.
TEST(CoupledRelaxation, ALiftedFingersDentGivesWayByItself) {
  const ContactBody body = make_contact_body(relaxing({}), kRadiusM);
  CoupledStorage storage(make_pinch(body, kRadiusM), free_of_clamps());
  CoupledState& state = storage.state();
  PortPoses pose = side_by_side();
  send_all(state, body, pose);
  for (int tick = 0; tick < 2000; ++tick) {
    pose[0].position_m.z() = std::max(kRadiusM - 0.002, pose[0].position_m.z() - 1e-5);
    pose[1].position_m.z() = pose[0].position_m.z();
    (void)step(state, {pose, 0}, kTickS);
  }
  pose[1].position_m.z() = kRadiusM + 0.001;
  WrenchCommand command = step(state, {pose, 0}, kTickS);
  EXPECT_NEAR(command.wrench[1].force_n.z(), 0.0, 1e-12);
  const double sunk_m = contact_place(state, 0).dimple_m;
  EXPECT_GT(sunk_m, 1e-5);
  for (int tick = 0; tick < 8000; ++tick) {
    command = step(state, {pose, 0}, kTickS);
  }
  EXPECT_LT(contact_place(state, 0).dimple_m, 0.5 * sunk_m);
  pose[0].position_m.z() = kRadiusM + 0.001;
  pose[1].position_m.x() += 0.001;
  command = step(state, {pose, 0}, kTickS);
  EXPECT_EQ(command.wrench[0].force_n.norm(), 0.0);
  EXPECT_EQ(command.wrench[1].force_n.norm(), 0.0);
  EXPECT_GT(command.memory_j, 0.0);
}

// A finger that has just come down beside another one's dent, which the account has
// lost: the dent cannot lift the finger, and stays.
TEST(CoupledRelaxation, WhatTheAccountCannotPayDoesNotHappen) {
  const ContactBody body = make_contact_body(relaxing({}), kRadiusM);
  CoupledStorage storage(make_pinch(body, kRadiusM), free_of_clamps());
  CoupledState& state = storage.state();
  PortPoses pose = side_by_side();
  send_all(state, body, pose);
  for (int tick = 0; tick < 2000; ++tick) {
    pose[1].position_m.z() = std::max(kRadiusM - 0.002, pose[1].position_m.z() - 1e-5);
    (void)step(state, {pose, 0}, kTickS);
  }
  pose[1].position_m.z() = kRadiusM + 0.001;
  while (state.model.field.equilibrium.force_n(0) < 1e-4) {  // in no time
    pose[0].position_m.z() -= 1e-6;
    (void)step(state, {pose, 0}, 0.0);
  }
  ASSERT_GT(state.ledger.dent_j + state.ledger.left_j, 1e-6);
  PassivityLedger& ledger = state.ledger;
  ledger.dissipated_j += ledger.dent_j + ledger.left_j;
  ledger.dent_j = ledger.left_j = 0.0;
  const double stored_j = ledger.stored_j;
  for (int tick = 0; tick < 20; ++tick) {
    (void)step(state, {pose, 0}, kTickS);
    EXPECT_LE(ledger.stored_j, stored_j + 1e-18) << tick;
  }
  EXPECT_GT(state.model.relaxing.shortened, 5U);
  EXPECT_LE(ledger.created_j, 1e-18);
  EXPECT_NEAR(imbalance_j(ledger), 0.0, 1e-15);
}

}  // namespace
}  // namespace palpate
