// Several contacts and two hands behind the live view: their equilibria are those of
// closed forms, and no switch creates energy.
#include "runtime/view/steered_contacts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "runtime/view/live_view.h"
#include "runtime/view/view_session.h"
#include "tests/support/fake_clock.h"
#include "tests/support/padded_plate.h"
#include "tests/support/said.h"

namespace palpate {
namespace {

// padded_plate.h: f = kPress d^2, c(r) = kReach / r.
constexpr double kPress = 2e4;   // [N/m^2]
constexpr double kReach = 2e-5;  // [m^2/N]
constexpr double kSide = 0.012;  // [m] between pads
// Curves of 41 samples in between, and rows stored as floats of 12 distances.
constexpr double kStored = 2e-3;

// f of two contacts that are d deep, each of which the other sinks by c f:
// d = sqrt(f / k) + c f.
double coupled_n(double depth_m, double c_m_per_n) {
  const double root =
      (-1.0 / std::sqrt(kPress) + std::sqrt(1.0 / kPress + 4.0 * c_m_per_n * depth_m)) /
      (2.0 * c_m_per_n);
  return root * root;
}

ViewSessionOptions options(std::vector<std::string> tools) {
  ViewSessionOptions o;
  o.tools = std::move(tools);
  o.device.coulomb_n = 0.0;
  o.device.resolution_m = 0.0;
  return o;
}

HandWish press(double x, double z, int hand = 0) {
  return {.hold = true, .target_m = {x, 0.0, z}, .hand = hand};
}

// With what tests look at.
class PressedSession : public ViewSession {
 public:
  using ViewSession::ViewSession;

  [[nodiscard]] SteeredContacts& contacts() {
    return dynamic_cast<SteeredContacts&>(body());
  }
  [[nodiscard]] const PassivityLedger& account() {
    return account_of(contacts().state());
  }
  [[nodiscard]] Eigen::Vector3d force_n(std::size_t hand = 0) const {
    return Eigen::Vector3d(hand_in(latest(), hand).force_n.data());
  }
  [[nodiscard]] Eigen::Vector3d torque_n_m(std::size_t hand = 0) const {
    return Eigen::Vector3d(hand_in(latest(), hand).torque_n_m.data());
  }
};

class SteeredContactsTest : public testing::Test {
 protected:
  // Holds until all is at rest.
  static void rest(PressedSession& session, const std::vector<HandWish>& wishes,
                   double seconds = 2.0) {
    for (const HandWish& wish : wishes) {
      session.follow(wish);
    }
    session.advance(static_cast<std::int64_t>(seconds * session.fast_hz()));
  }

  static void expect_account(PressedSession& session) {
    EXPECT_EQ(session.fault(), Fault::kNone);
    EXPECT_GE(session.account().work_j, -1e-12);
    EXPECT_NEAR(imbalance_j(session.account()), 0.0, 1e-12);
    EXPECT_LT(session.account().created_j, 1e-12);
  }

  ResponseDatabase database_ = padded_plate(2);
};

TEST_F(SteeredContactsTest, TwoPadsRestWhereCoupledBodyAndGripBalance) {
  PressedSession session(database_, options({"pads"}));
  rest(session, {press(0.0, 0.002)});
  const double depth = session.latest().depth_m;
  const double force = session.force_n().z();
  EXPECT_NEAR(force, 2.0 * coupled_n(depth, kReach / kSide), kStored * force);
  // The hand pulls to 3 mm below touch.
  const double grip = options({}).device.hand_n_per_m;
  EXPECT_NEAR(force, grip * (0.003 - depth), 1e-3 * force);
  EXPECT_EQ(session.latest().contacts, 2);
  expect_account(session);
}

TEST_F(SteeredContactsTest, ComparesWithContactsAddedUpAndChangesNothingByThat) {
  PressedSession shown(database_, options({"pads"}));
  PressedSession unseen(database_, options({"pads"}));
  for (int i = 0; i < 60; ++i) {
    const HandWish wish = press(2e-4 * i, 0.002);
    rest(shown, {wish}, 0.02);
    rest(unseen, {wish}, 0.02);
    (void)shown.frame();
    EXPECT_EQ(shown.force_n(), unseen.force_n());
    EXPECT_EQ(shown.account().work_j, unseen.account().work_j);
  }
  rest(shown, {press(0.0, 0.002)}, 1.0);
  const double depth = shown.latest().depth_m;
  const ViewHands hands = shown.frame().hands.value();
  EXPECT_NEAR(hands.hand[0].added_up_n.z(), 2.0 * kPress * depth * depth,
              kStored * hands.hand[0].added_up_n.z());
  EXPECT_NEAR(hands.hand[0].coupled_n.z(), 2.0 * coupled_n(depth, kReach / kSide),
              kStored * hands.hand[0].coupled_n.z());
  EXPECT_GT(hands.hand[0].added_up_n.z(), 1.1 * hands.hand[0].coupled_n.z());
  ASSERT_EQ(hands.touch.size(), 2U);
  EXPECT_NEAR(hands.touch[0].depth_m, depth, 1e-6);
  EXPECT_NEAR(hands.touch[0].own_m,
              std::sqrt(coupled_n(depth, kReach / kSide) / kPress), 1e-5);
  EXPECT_NEAR(hands.touch[0].share.sum(), 1.0, 1e-12);
}

// The switch itself is no work of the hand: stored energy rises no further than the
// tank, delta_0 takes the rest.
TEST_F(SteeredContactsTest, TheSwitchIsAChangeThatTheLedgerBalances) {
  PressedSession session(database_, options({"pads"}));
  session.set({.friction = 0.0});  // which would leave something in the tank
  rest(session, {press(0.0, 0.002)});
  const PassivityLedger before = session.account();
  session.set({.coupled = false});
  const PassivityLedger& after = session.account();
  EXPECT_NEAR(after.work_j, before.work_j, 1e-15);
  EXPECT_LE(after.stored_j + after.tank_j, before.stored_j + before.tank_j + 1e-15);
  EXPECT_GT(after.stored_j, 0.9 * before.stored_j);
  EXPECT_GT(session.contacts().state().model.field.shift_m, 1e-5);
  // What is shown beside it is without that.
  session.advance(1);
  const double at = session.latest().depth_m;
  const double added_up = (*session.contacts().elastic(false))[0].force_n.z();
  EXPECT_NEAR(added_up, 2.0 * kPress * at * at, kStored * added_up);
  EXPECT_GT(added_up, 1.05 * session.force_n().z());
  // Nothing is left of it once the contacts have been lifted.
  session.let_go();
  session.advance(4000);
  EXPECT_FALSE(session.touching());
  rest(session, {press(0.0, 0.002)});
  const double depth = session.latest().depth_m;
  const double force = session.force_n().z();
  EXPECT_NEAR(force, 2.0 * kPress * depth * depth, kStored * force);
  EXPECT_EQ(session.contacts().state().model.field.shift_m, 0.0);
  expect_account(session);
  // And back: softer at once, what that frees waits in the tank.
  session.set({.coupled = true});
  EXPECT_GT(session.account().tank_j, 0.0);
  session.advance(2000);
  EXPECT_LT(session.force_n().z(), force);
  expect_account(session);
}

TEST_F(SteeredContactsTest, NoSwitchingWhileTheToolMovesAndTurnsCreatesEnergy) {
  PressedSession session(database_, options({"pads"}));
  double lowest_j = 0.0;
  int changes = 0;
  for (int i = 0; i < 400; ++i) {
    const double t = 0.05 * i;
    HandWish wish = press(0.02 * std::sin(t), 0.002 + 0.002 * std::sin(2.7 * t));
    wish.turn = Eigen::AngleAxisd(0.3 * std::sin(1.9 * t), Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(t, Eigen::Vector3d::UnitZ());
    session.follow(wish);
    if (i % 7 == 3) {
      session.set({.coupled = ++changes % 2 == 0});
    }
    if (i % 31 == 5) {
      session.set({.stiffness_scale = 1.0 + 0.5 * std::sin(t)});
    }
    session.advance(37);
    lowest_j = std::min(lowest_j, session.account().work_j);
    EXPECT_LT(session.account().created_j, 1e-12);
  }
  EXPECT_GE(lowest_j, -1e-12);
  EXPECT_GT(session.account().interventions, 0U);
  expect_account(session);
}

TEST_F(SteeredContactsTest, StiffnessGoesForCurvesAndCompliance) {
  PressedSession session(database_, options({"pads"}));
  session.set({.stiffness_scale = 0.5});
  rest(session, {press(0.0, 0.002)});
  // n times the forces, an n-th of the compliance: the same depths under the contacts.
  const double depth = session.latest().depth_m;
  const double force = session.force_n().z();
  EXPECT_NEAR(force, coupled_n(depth, kReach / kSide), kStored * force);
}

TEST_F(SteeredContactsTest, ATiltedToolIsTurnedBackAndTurnsNoFasterThanAWrist) {
  PressedSession session(database_, options({"pads"}));
  rest(session, {press(0.0, 0.002)});
  EXPECT_NEAR(session.torque_n_m().y(), 0.0, 1e-6);
  HandWish wish = press(0.0, 0.002);
  wish.turn = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY());
  session.follow(wish);
  Eigen::Quaterniond last = session.frame().hands->hand[0].turn;
  double fastest = 0.0;
  for (int tick = 0; tick < 1000; ++tick) {
    session.advance(1);
    const Eigen::Quaterniond now = session.frame().hands->hand[0].turn;
    fastest = std::max(fastest, last.angularDistance(now) * session.fast_hz());
    last = now;
  }
  EXPECT_NEAR(last.angularDistance(*wish.turn), 0.0, 1e-5);
  EXPECT_GT(fastest, 1.0);
  EXPECT_LE(fastest, PointerHand::kTurnRadPerS * (1.0 + 1e-6));
  // About y, +x goes down, and is pressed up there.
  EXPECT_LT(session.torque_n_m().y(), -1e-4);
}

TEST_F(SteeredContactsTest, TwoHandsSinkTheBodyUnderEachOther) {
  constexpr double kApart = 0.014;
  PressedSession session(database_, options({"ball", "ball"}));
  const double half = 0.5 * kApart;
  rest(session, {press(-half, 0.002, 0), press(half, 0.002, 1)});
  const double depth = session.latest().depth_m;
  const Eigen::Vector3d first = session.force_n();
  const Eigen::Vector3d second = session.force_n(1);
  // Where the places are: friction holds them apart.
  const ViewHands hands = session.frame().hands.value();
  const double apart = (hands.touch[0].point_m - hands.touch[1].point_m).norm();
  EXPECT_NEAR(hands.hand[0].coupled_n.z(), coupled_n(depth, kReach / apart),
              kStored * first.z());
  EXPECT_NEAR(first.z(), second.z(), 1e-3 * first.z());
  // Nearer to each other they would have it softer: drawn together, by equal forces.
  EXPECT_GT(hands.hand[0].coupled_n.x(), 0.01 * first.z());
  EXPECT_NEAR(hands.hand[0].coupled_n.x(), -hands.hand[1].coupled_n.x(),
              1e-3 * first.z());
  // Each is lifted from where it touches itself.
  for (int hand = 0; hand < 2; ++hand) {
    const std::int32_t triangle = session.contacts().triangle_under(
        static_cast<std::size_t>(hand), session.latest());
    ASSERT_GE(triangle, 0);
    const double x = database_.body.position_m(database_.body.triangle(triangle, 0), 0);
    EXPECT_NEAR(x, hand == 0 ? -half : half, half) << hand;
  }
  // One lifts: the other has more of the body.
  session.follow({.hold = false, .hand = 1});
  session.advance(4000);
  EXPECT_EQ(session.force_n(1).norm(), 0.0);
  const double alone = session.latest().depth_m;
  EXPECT_NEAR(session.force_n().z(), kPress * alone * alone, kStored * first.z());
  EXPECT_GT(session.force_n().z(), 1.02 * first.z());
  EXPECT_TRUE(session.holding());
  session.let_go();
  EXPECT_FALSE(session.holding());
  session.advance(4000);
  EXPECT_FALSE(session.touching());
  expect_account(session);
}

TEST_F(SteeredContactsTest, TwoHandsBeginClearOfTheBodyAndOfEachOther) {
  PressedSession session(database_, options({"ball", "pads"}));
  const ViewHands hands = session.frame().hands.value();
  ASSERT_EQ(hands.hand.size(), 2U);
  EXPECT_GT((hands.hand[0].tool_m - hands.hand[1].tool_m).norm(),
            2.0 * kPadRadius + 0.5 * kSide);
  EXPECT_GT(hands.hand[0].tool_m.z(), kPadRadius);
  session.advance(200);
  EXPECT_FALSE(session.touching());
}

class OnePageOutbox : public ViewOutbox {
 public:
  void send(ViewClient /*client*/, std::string text) override {
    sent.push_back(std::move(text));
  }
  void send_latest(ViewClient /*client*/,
                   const std::shared_ptr<const std::string>& text) override {
    frame = *text;
  }
  std::vector<std::string> sent;
  std::string frame;
};

TEST_F(SteeredContactsTest, APageSteersBothHandsAndARecordingDoesItAgain) {
  PressedSession session(database_, options({"ball", "pads"}));
  FakeClock wall(1);
  LiveView view(session, wall);
  OnePageOutbox outbox;
  view.answer_through(outbox);
  view.opened(1);
  const auto pass = [&](const std::vector<std::string>& says) {
    for (const std::string& one : says) {
      view.received(1, one);
    }
    wall.sleep_until_ns(wall.now_ns() + 16'666'667);
    view.frame();
  };
  pass({});
  const std::vector<std::string> pinch = {
      R"({"type":"point","hold":true,"hand":0,"target_m":[-0.01,0,0.002]})",
      R"({"type":"point","hold":true,"hand":1,"target_m":[0.012,0,0.003],)"
      R"("turn":[0,0.05,0.1,1]})"};
  const auto poke = [&](const std::vector<std::string>& says) {
    std::vector<Wrench> wrench;
    for (int i = 0; i < 120; ++i) {
      pass(i >= 20 && i < 80 ? says : std::vector<std::string>{});
      if (i == 60 && !says.empty()) {
        pass({R"({"type":"point","hold":false,"hand":0})"});
      } else if (i == 60) {
        pass({});
      }
      wrench.push_back({session.force_n(0), session.torque_n_m(0)});
      wrench.push_back({session.force_n(1), session.torque_n_m(1)});
    }
    return wrench;
  };
  view.received(1, R"({"type":"run","do":"record"})");
  const std::vector<Wrench> first = poke(pinch);
  view.received(1, R"({"type":"run","do":"record"})");
  for (int i = 0; i < 30; ++i) {
    pass({});
  }
  view.received(1, R"({"type":"run","do":"replay"})");
  const std::vector<Wrench> second = poke({});
  double most_n_m = 0.0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].force_n, second[i].force_n) << i;
    EXPECT_EQ(first[i].torque_n_m, second[i].torque_n_m) << i;
    most_n_m = std::max(most_n_m, first[i].torque_n_m.norm());
  }
  EXPECT_GT(most_n_m, 1e-4);
  EXPECT_TRUE(contains(outbox.frame, R"("contacts":[)"));
  EXPECT_TRUE(contains(outbox.frame, R"("torque2_n_m":[)"));
  EXPECT_EQ(outbox.sent.size(), 1U) << outbox.sent.back();
}

TEST_F(SteeredContactsTest, RefusesInASentence) {
  const auto refusal = [](auto&& what) {
    try {
      what();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  PressedSession session(database_, options({"pads"}));
  EXPECT_TRUE(contains(refusal([&] {
                         session.follow(press(0.0, 0.0, 1));
                       }),
                       "hand 1 is not there"));
  EXPECT_TRUE(contains(refusal([&] {
                         session.set({.model = LocalModel::kElement, .coupled = false});
                       }),
                       "\"potential\" alone"));
  EXPECT_TRUE(session.frame().hands->coupled);
  EXPECT_TRUE(
      contains(refusal([&] {
                 const ViewSession none(database_, options({"ball", "ball", "ball"}));
               }),
               "must be 1 to 2"));
  ViewSessionOptions slow = options({"pads"});
  slow.slow_hz = 0.5;
  EXPECT_TRUE(contains(refusal([&] {
                         const ViewSession none(database_, slow);
                       }),
                       "slow rate is 0.5 Hz"));
  const ResponseDatabase without = padded_plate(2, false);
  EXPECT_TRUE(contains(refusal([&] {
                         const ViewSession none(without, options({"pads"}));
                       }),
                       "has no table of compliance"));
}

// One sphere in a set of its own is rendered as one contact.
TEST_F(SteeredContactsTest, ASetOfOneContactIsRenderedToo) {
  const ResponseDatabase one = padded_plate(1);
  PressedSession session(one, options({"pads"}));
  rest(session, {press(0.0, 0.002)});
  const double depth = session.latest().depth_m;
  const double force = session.force_n().z();
  EXPECT_NEAR(force, kPress * depth * depth, kStored * force);
  session.set({.stiffness_scale = 0.5, .coupled = false});
  session.advance(2000);
  EXPECT_LT(session.force_n().z(), 0.9 * force);
  EXPECT_EQ(session.frame().hands->touch.size(), 1U);
  expect_account(session);
}

}  // namespace
}  // namespace palpate
