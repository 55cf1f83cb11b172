// A needle on a body of three layers: what it feels, and that its account holds.
#include "runtime/fast/needle_step.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/bench/bench_body.h"
#include "runtime/fast/fast_step.h"
#include "tests/support/energy_account.h"
#include "tests/support/layered_body.h"
#include "tests/support/tick.h"

namespace palpate {
namespace {

// A tip that goes straight in and out over the middle of the body.
class Needle {
 public:
  explicit Needle(const PunctureRules& rules = layered_rules(),
                  const BenchBodyOptions& options = layered_options(),
                  double rupture = kSkinN)
      : body_(punctured_body(options, rupture)), state_(needle_state(rules)) {}

  // To a depth of the tip at a speed; each tick's force along the axis.
  double go_to(double depth_m, double speed_m_per_s, double tick_s = kTickS) {
    const double step_m = speed_m_per_s * tick_s;
    while (std::abs(depth_m - depth_m_) > 1e-12) {
      depth_m_ += std::clamp(depth_m - depth_m_, -step_m, step_m);
      tick(tick_s);
    }
    return force_n_.z();
  }

  void tick(double tick_s = kTickS) {
    const Eigen::Vector3d x =
        Eigen::Vector3d(0.0213, 0.0187, kNeedleRadiusM - depth_m_) + aside_m;
    send(*state_, body_, x);
    force_n_ = account_.step(*state_, x, tick_s).force_n;
    peak_n = std::max(peak_n, force_n_.z());
    lowest_n = std::min(lowest_n, force_n_.z());
    open_j = std::max(open_j, std::abs(imbalance_j(state_->ledger)));
  }

  [[nodiscard]] double depth_m() const { return depth_m_; }
  [[nodiscard]] const Channel& channel() const { return state_->needle.channel[0]; }
  [[nodiscard]] FastState& state() { return *state_; }
  [[nodiscard]] const Account& account() const { return account_; }
  [[nodiscard]] const Eigen::Vector3d& force_n() const { return force_n_; }

  double peak_n = 0.0;
  double lowest_n = 0.0;
  double open_j = 0.0;
  Eigen::Vector3d aside_m = Eigen::Vector3d::Zero();

 private:
  BenchBody body_;
  std::unique_ptr<FastState> state_;
  Account account_;
  double depth_m_ = -0.001;
  Eigen::Vector3d force_n_ = Eigen::Vector3d::Zero();
};

TEST(NeedleStep, BeforeThePunctureNothingDiffersFromAnotherTool) {
  BenchBodyOptions wavy = layered_options();
  wavy.wave_m = 0.004;
  wavy.contrast = 20.0;
  wavy.tilt_rad = 0.2;
  wavy.friction_max = 0.5;
  const BenchBody body = punctured_body(wavy);
  PunctureRules hard = layered_rules();
  const auto needle = needle_state(hard);
  const auto tool = needle_state({});
  BenchWalkOptions walk;
  walk.ticks = 20000;
  walk.tool_radius_m = kNeedleRadiusM;
  walk.depth_m = 0.003;  // less than the skin bears
  for (const Eigen::Vector3d& x : make_bench_walk(body, walk)) {
    send(*needle, body, x);
    send(*tool, body, x);
    const FastCommand a = step(*needle, {x, 0}, kTickS);
    const FastCommand b = step(*tool, {x, 0}, kTickS);
    ASSERT_EQ(a.force_n, b.force_n);
    ASSERT_EQ(a.stored_j, b.stored_j);
    ASSERT_EQ(a.dissipated_j, b.dissipated_j);
  }
  EXPECT_EQ(needle->needle.channels, 0);
}

TEST(NeedleStep, TheSkinBreaksAtItsForceAndTheTipCutsThen) {
  Needle needle;
  needle.go_to(layered_m(kSkinN) - 1e-4, 0.01);
  EXPECT_EQ(needle.state().needle.channels, 0);
  EXPECT_NEAR(needle.force_n().z(), layered_n(layered_m(kSkinN) - 1e-4), 0.01);
  needle.go_to(layered_m(kSkinN) + 1e-4, 0.01);
  ASSERT_EQ(needle.state().needle.active, 0);
  EXPECT_NEAR(needle.peak_n, kSkinN, 0.01);
  // Through both thin layers at once, as the force at their ends breaks them; the tip
  // force is that of cutting the third.
  const Channel& channel = needle.channel();
  EXPECT_EQ(channel.layer, 1);
  const double tip_n = needle.force_n().z() - kShaftNPerM * channel.shaft_m;
  EXPECT_NEAR(tip_n, 0.2, 0.002);
  EXPECT_NEAR(channel.axis.z(), 1.0, 1e-6);
}

TEST(NeedleStep, EachMembraneAddsItsPeak) {
  Needle needle;
  needle.go_to(layered_m(kSkinN) + 1e-4, 0.01);
  needle.peak_n = 0.0;
  needle.go_to(0.012 + layered_m(1.5) - 2e-4, 0.01);
  EXPECT_EQ(needle.channel().layer, 1);
  EXPECT_EQ(needle.channel().depth_m, 0.012);
  const double shaft_n = 20.0 * 0.002 + 10.0 * 0.010;
  EXPECT_NEAR(needle.peak_n, layered_n(layered_m(1.5) - 2e-4) + shaft_n, 0.01);
  EXPECT_EQ(needle.channel().broke[2].force_n, 0.0);
  needle.go_to(0.012 + layered_m(1.5) + 2e-4, 0.01);
  EXPECT_EQ(needle.channel().layer, 2);
  // Each membrane keeps its peak, and where the tip was; to a tick's way.
  const auto& broke = needle.channel().broke;
  EXPECT_NEAR(broke[0].force_n, kSkinN, 0.01);
  EXPECT_NEAR(broke[0].tip_m, layered_m(kSkinN), 2e-5);
  EXPECT_NEAR(broke[2].force_n, 1.5 + shaft_n, 0.01);
  EXPECT_NEAR(broke[2].tip_m, 0.012 + layered_m(1.5), 2e-5);
}

// E(e) is the integral of f up to e. The force is 1.1 N where it reaches W, that of the
// membrane 1.5 N.
TEST(NeedleStep, AMembraneBelowTheSkinMayBreakByItsEnergy) {
  PunctureRules rules = layered_rules();
  const double break_m = layered_m(1.1);
  rules.material[2].membrane_j = 1.1 * break_m / 2.5;
  Needle needle(rules);
  needle.go_to(0.012 + break_m - 2e-4, 0.01);
  EXPECT_EQ(needle.channel().layer, 1);
  EXPECT_EQ(needle.channel().depth_m, 0.012);
  const double released_j = needle.state().needle.released_j;
  needle.go_to(0.012 + break_m + 2e-4, 0.01);
  EXPECT_EQ(needle.channel().layer, 2);
  const double shaft_n = 20.0 * 0.002 + 10.0 * 0.010;
  EXPECT_NEAR(needle.channel().broke[2].force_n, 1.1 + shaft_n, 0.01);
  EXPECT_NEAR(needle.channel().broke[2].tip_m, 0.012 + break_m, 2e-5);
  EXPECT_GT(needle.state().needle.released_j, released_j);
  EXPECT_LT(needle.open_j, 1e-12);
}

TEST(NeedleStep, AFlowThroughSeveralMembranesEndsInTheLastThatYields) {
  PunctureRules rules = layered_rules();
  rules.material[1].membrane_n = 0.1;
  rules.material[2] = {0.15, 0.1, 0.0};
  Needle needle(rules);
  needle.go_to(layered_m(kSkinN) + 1e-4, 0.01);
  EXPECT_EQ(needle.channel().layer, 1);
  // Cutting takes more than the last membrane bears.
  needle.go_to(0.012 + layered_m(0.2) + 1e-4, 0.01);
  EXPECT_EQ(needle.channel().layer, 2);
}

TEST(NeedleStep, EventsAreAtOneDepthAtEveryRate) {
  for (const double rate_hz : {100.0, 1000.0, 4000.0}) {
    Needle needle;
    const double speed = 0.01;
    while (needle.state().needle.channels == 0) {
      needle.go_to(needle.depth_m() + speed / rate_hz, speed, 1.0 / rate_hz);
    }
    const double depth_m = needle.depth_m();
    EXPECT_GE(depth_m, layered_m(kSkinN) - 2e-5) << rate_hz;
    EXPECT_LE(depth_m, layered_m(kSkinN) + speed / rate_hz + 2e-5) << rate_hz;
  }
}

TEST(NeedleStep, ASecondInsertionMeetsFrictionAloneWhereItHasBeen) {
  Needle needle;
  needle.go_to(0.025, 0.01);
  needle.go_to(-0.001, 0.01);
  EXPECT_EQ(needle.state().needle.active, -1);
  const double first_j = needle.account().net_j;
  const double cut_m = needle.channel().depth_m;
  needle.peak_n = 0.0;
  needle.go_to(cut_m - 1e-4, 0.01);
  ASSERT_EQ(needle.state().needle.active, 0);
  EXPECT_EQ(needle.state().needle.channels, 1);
  const double shaft_n = 20.0 * 0.002 + 10.0 * 0.010 + 15.0 * (cut_m - 0.012 - 1e-4);
  EXPECT_NEAR(needle.force_n().z(), shaft_n, 1e-3 * shaft_n);
  EXPECT_NEAR(needle.peak_n, shaft_n, 1e-3 * shaft_n);  // no peak at any membrane
  needle.go_to(0.027, 0.01);
  EXPECT_GT(needle.channel().depth_m, cut_m);  // cutting goes on
  EXPECT_GT(first_j, needle.account().net_j - first_j);
}

// Both works in closed form: to 30 mm and out.
TEST(NeedleStep, WorksOfTwoInsertionsAreThoseOfTheModel) {
  PunctureRules rules = layered_rules();
  for (PunctureMaterial& material : rules.material) {
    material.static_ratio = 1.0;
  }
  rules.shaft_n_per_m = 1e5;  // slips at once
  Needle needle(rules);
  const double end_m = 0.025;
  needle.go_to(end_m, 0.002);
  const double l = needle.channel().depth_m;
  needle.go_to(-0.001, 0.002);
  const double first_j = needle.account().net_j;
  const NeedleState& state = needle.state().needle;
  EXPECT_NEAR(l, end_m - layered_m(0.4), 1e-5);
  const double crack_j = 0.5 * 0.002 + 0.2 * 0.010 + 0.4 * (l - 0.012);
  EXPECT_NEAR(state.crack_j, crack_j, 1e-3 * crack_j);
  EXPECT_NEAR(first_j, crack_j + state.released_j + state.shaft_j, 1e-9);
  needle.go_to(l, 0.002);
  const double before_j = state.shaft_j;
  needle.go_to(-0.001, 0.002);
  const auto friction_j = [](double to) {  // integral of Phi
    const double a = std::min(to, 0.002), b = std::clamp(to - 0.002, 0.0, 0.010);
    const double c = std::max(0.0, to - 0.012);
    return 20.0 * a * a / 2 + 20.0 * a * b + 10.0 * b * b / 2 +
           (20.0 * a + 10.0 * b) * c + 15.0 * c * c / 2;
  };
  const double second_j = needle.account().net_j - first_j;
  // A force that is held for a tick gives half k_b dx^2, at each of its ticks.
  const double tick_m = 0.002 * kTickS;
  const double held_j = 0.5 * rules.shaft_n_per_m * tick_m * 2.0 * l;
  EXPECT_NEAR(second_j, 2.0 * friction_j(l) + held_j, 1e-3 * second_j);
  EXPECT_GT(state.shaft_j, before_j);
}

TEST(NeedleStep, TheShaftsLoopIsTwiceItsFrictionWithAStaticPeak) {
  PunctureRules rules = layered_rules();
  rules.shaft_n_per_m = 4000.0;
  Needle needle(rules);
  needle.go_to(0.028, 0.01);
  needle.go_to(0.024, 0.01);
  const Channel& channel = needle.channel();
  const double kinetic_n = 20.0 * 0.002 + 10.0 * 0.010 + 15.0 * (0.024 - 0.012);
  EXPECT_NEAR(needle.force_n().z(), -kinetic_n, 0.02 * kinetic_n);
  // Half a second of rest, then the other way: static friction first.
  for (int n = 0; n < 1000; ++n) {
    needle.tick();
  }
  EXPECT_FALSE(channel.slips);
  needle.peak_n = -1.0;
  needle.go_to(0.0245, 0.001);
  EXPECT_NEAR(needle.peak_n, kStaticRatio * kinetic_n, 0.02 * kinetic_n);
  EXPECT_NEAR(needle.force_n().z(), kinetic_n, 0.03 * kinetic_n);
  EXPECT_TRUE(channel.slips);
}

TEST(NeedleStep, AnInsertedShaftIsHeldAcross) {
  Needle needle;
  needle.go_to(0.02, 0.01);
  for (int n = 1; n <= 100; ++n) {
    needle.aside_m.x() = 1e-5 * n;
    needle.tick();
  }
  const double k = 5e3 * needle.channel().inserted_m;
  EXPECT_NEAR(needle.force_n().x(), -k * 1e-3, 1e-9);
  // Deeper, it bears the same across, and less energy.
  needle.go_to(0.025, 0.01);
  EXPECT_NEAR(needle.force_n().x(), -k * 1e-3, 1e-9);
  EXPECT_LT(needle.open_j, 1e-12);
}

// The force is the gradient of the energy, on a body whose axis leans from its normal.
TEST(NeedleStep, TheForceIsTheGradientOfItsPotential) {
  BenchBodyOptions options = layered_options();
  options.tilt_rad = 0.3;
  options.wave_m = 0.002;
  options.friction_min = options.friction_max = 0.5;
  PunctureRules bone = layered_rules();
  bone.material[2].membrane_n = std::numeric_limits<double>::infinity();
  Needle needle(bone, options);
  needle.aside_m.x() = 1e-4;
  needle.go_to(0.016, 0.01);
  ASSERT_EQ(needle.state().needle.active, 0);
  ASSERT_LT((needle.channel().axis - Eigen::Vector3d::UnitZ()).norm(), 0.5);
  ASSERT_GT((needle.channel().axis - Eigen::Vector3d::UnitZ()).norm(), 0.02);
  needle.aside_m.x() = 3e-4;
  needle.tick();
  const Eigen::Vector3d x = needle.state().latest.position_m;
  constexpr double kStepM = 1e-7;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d h = kStepM * Eigen::Vector3d::Unit(i);
    const double slope =
        (potential_j(needle.state(), x + h) - potential_j(needle.state(), x - h)) /
        (2.0 * kStepM);
    EXPECT_NEAR(needle.force_n()[i], -slope, 1e-5) << i;
  }
}

TEST(NeedleStep, WhatCannotBeCutIsFeltAsTheCurve) {
  PunctureRules bone = layered_rules();
  bone.material[2].membrane_n = std::numeric_limits<double>::infinity();
  Needle needle(bone);
  needle.go_to(0.022, 0.01);
  EXPECT_EQ(needle.channel().depth_m, 0.012);
  EXPECT_NEAR(needle.force_n().z(), layered_n(0.01) + 20.0 * 0.002 + 10.0 * 0.010,
              0.02);
}

// By energy: a faster press of a body that relaxes breaks it at less depth.
TEST(NeedleStep, ByEnergyAFasterTipBreaksAtLessDepth) {
  BenchBodyOptions options = layered_options();
  options.relaxing = {0.5};
  options.relaxation_s = {0.2};
  PunctureRules rules = layered_rules();
  rules.by_energy = true;
  const auto depth_m = [&](double speed) {
    Needle needle(rules, options, 5e-3);
    double at = 0.0;
    while (needle.state().needle.channels == 0 && at < 0.03) {
      at += 1e-4;
      needle.go_to(at, speed);
    }
    return at;
  };
  EXPECT_LT(depth_m(0.2) + 5e-4, depth_m(0.005));
}

TEST(NeedleStep, WrongRulesAreSaid) {
  FastConfig config;
  config.model = LocalModel::kPotential;
  config.puncture = layered_rules();
  EXPECT_EQ(check(config), nullptr);
  config.model = LocalModel::kElement;
  EXPECT_STREQ(check(config), "a needle needs the model potential or facets");
  config.model = LocalModel::kFacets;
  config.puncture.material[0].static_ratio = 0.9;
  EXPECT_NE(check(config), nullptr);
  config.puncture = layered_rules();
  config.puncture.shaft_n_per_m = 0.0;
  EXPECT_NE(check(config), nullptr);
  config.puncture = layered_rules();
  config.puncture.material[1].cutting_n = std::nan("");
  EXPECT_NE(check(config), nullptr);
}

}  // namespace
}  // namespace palpate
