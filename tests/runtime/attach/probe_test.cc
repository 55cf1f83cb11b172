// What a probe finds of devices is what they were made with: of a simulated one in
// simulated time, and of the emulations through their wires.
#include "runtime/attach/probe.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "runtime/attach/device_choice.h"
#include "runtime/attach/probe_file.h"
#include "runtime/device/stability_margin.h"
#include "runtime/emulation/emulated_haply.h"
#include "runtime/emulation/emulated_inverse3.h"
#include "runtime/inverse/emulated_inverse.h"
#include "runtime/inverse/inverse_link.h"
#include "tests/support/simulated_link.h"
#include "tests/support/test_data.h"
#include "tests/support/undisturbed.h"

namespace palpate {
namespace {

ProbeReport probed(const SimulatedDeviceConfig& config, const ProbeOptions& options) {
  const HandTarget nobody;
  SimulatedLink link(config, nobody);
  link.open();
  return probe(link, options, {}, link.clock);
}

// Of masses, frictions, dampings, steps and delays that devices have, through a tenth
// of each; the exchange's middle is 0.1 ms.
TEST(Probe, FindsWhatASimulatedDeviceIsLike) {
  struct Made {
    double mass_kg, coulomb_n, damping, resolution_m;
    int delay_ticks;
  };
  for (const Made& made :
       {Made{0.12, 0.03, 0.5, 5e-5, 4}, Made{0.05, 0.02, 0.3, 1e-5, 2},
        Made{0.3, 0.1, 1.0, 2e-5, 8}, Made{0.12, 0.03, 0.0, 5e-5, 4}}) {
    SimulatedDeviceConfig config = let_go();
    config.mass_kg = made.mass_kg;
    config.coulomb_n = made.coulomb_n;
    config.damping_n_s_per_m = made.damping;
    config.resolution_m = made.resolution_m;
    config.delay_ticks = made.delay_ticks;
    const ProbeReport report = probed(config, {.axes = {1}});
    const ProbedAxis& found = report.axis.at(0);
    const double delay_s = 1e-3 * made.delay_ticks + 1e-4;
    EXPECT_NEAR(found.mass_kg, made.mass_kg, 0.05 * made.mass_kg) << probe_text(report);
    EXPECT_NEAR(found.friction_n, made.coulomb_n, 0.1 * made.coulomb_n)
        << probe_text(report);
    EXPECT_NEAR(found.damping_n_s_per_m, made.damping,
                0.1 * made.damping + 3.0 * found.damping_sd_n_s_per_m)
        << probe_text(report);
    EXPECT_LT(found.damping_sd_n_s_per_m, 0.1);
    EXPECT_NEAR(report.resolution_m, made.resolution_m, 1e-9);
    EXPECT_NEAR(found.delay_s, delay_s, 0.1 * delay_s) << probe_text(report);
    EXPECT_TRUE(found.has_delay());
    EXPECT_LE(report.force_max_n, kProbeForceMaxN);
  }
}

// While a force is on its way the ramp rises by 0.5 N/s * 8.1 ms = 7 % of the friction.
TEST(Probe, TakesTheDelayOffTheFriction) {
  SimulatedDeviceConfig config = let_go();
  config.coulomb_n = 0.06;
  config.delay_ticks = 8;
  const ProbeReport report = probed(config, {.rise_n_per_s = 0.5});
  EXPECT_NEAR(report.axis.at(0).friction_n, 0.06, 0.04 * 0.06) << probe_text(report);
}

// The bound is then on the safe side: the delay of nothing, and what it can tell.
TEST(Probe, SaysOfNoDelayHowFineItCanTell) {
  const ProbeReport report = probed(let_go(), {});
  const ProbedAxis& found = report.axis.at(0);
  EXPECT_FALSE(found.has_delay()) << probe_text(report);
  EXPECT_GE(found.delay_resolution_s, 2e-4);  // the exchange
  EXPECT_LT(found.delay_s + found.delay_resolution_s, 1e-3);
  EXPECT_NE(probe_text(report).find("below 0."), std::string::npos);
  const DeviceLimits limits = probed_limits(report, {.force_max_n = 3.0});
  EXPECT_GE(limits.delay_s, 1e-4);
  EXPECT_EQ(limits.force_max_n, 3.0);
}

TEST(Probe, LimitsAreOnTheSafeSideOfWhatWasMade) {
  SimulatedDeviceConfig config = let_go();
  config.delay_ticks = 3;
  const DeviceLimits limits = probed_limits(probed(config, {.axes = {0, 2}}), {});
  EXPECT_LE(limits.damping_n_s_per_m, 0.5);
  EXPECT_GE(limits.damping_n_s_per_m, 0.3);
  EXPECT_LE(limits.coulomb_n, 0.033);
  EXPECT_GE(limits.delay_s, 3e-3);
  EXPECT_LE(stability_bounds(limits, 1e-3).delay_n_per_m, 0.5 / (0.5e-3 + 3e-3));
  // A damping that cannot be distinguished from none is not taken for one.
  config.damping_n_s_per_m = 0.0;
  EXPECT_EQ(
      probed_limits(probed(config, {}), {.damping_n_s_per_m = 0.7}).damping_n_s_per_m,
      0.7);
}

// Of an axis along which nothing was found what is assumed stands, where it is worse.
TEST(Probe, LimitsAreOfTheAxesThatWereNotFoundToo) {
  ProbeReport report = probed(let_go(), {});
  ProbedAxis none;
  none.axis = 1;
  none.failure = "somebody holds it";
  report.axis.push_back(none);
  EXPECT_EQ(axes_not_found(report), "y");
  const DeviceLimits limits = probed_limits(
      report, {.damping_n_s_per_m = 0.1, .coulomb_n = 0.01, .delay_s = 5e-3});
  EXPECT_EQ(limits.damping_n_s_per_m, 0.1);
  EXPECT_EQ(limits.coulomb_n, 0.01);
  EXPECT_EQ(limits.delay_s, 5e-3);
}

// A stranger's file, read in a terminal.
TEST(Probe, PrintsNothingThatATerminalObeys) {
  ProbeReport report = probed(let_go(), {});
  report.device = "falcon\x1b[2J";
  report.palpate = "\x1b]0;1\x07";
  report.axis.at(0).failure = "\x1b[31mred";
  EXPECT_EQ(probe_text(report).find('\x1b'), std::string::npos);
}

// A hand that does as is said: holds, moves to each side; and may let go.
class LedHand {
 public:
  explicit LedHand(bool lets_go) : link(config(), target) {
    link.open();
    guide.say = [this](const std::string& text) {
      EXPECT_TRUE(text[0] == '4' || link.force_max_n == 0.0) << text;
      said.push_back(text);
      const bool right = text.find("right") != std::string::npos;
      const bool down = text.find("down") != std::string::npos;
      target = {.position_m = {right ? 0.05 : 0.0, down ? -0.04 : 0.0, 0.0}};
    };
    guide.await = [this, lets_go](const std::string& text) {
      said.push_back(text);
      target = {};
      goes_along = lets_go && text.find("let go") != std::string::npos;
    };
    guide.progress = [this](double s) {
      left_s.push_back(s);
    };
    link.exchanged = [this] {
      if (goes_along) {  // no force of the hand on the tool
        target = {link.motion().position_m, link.motion().velocity_m_per_s};
      }
    };
  }

  static SimulatedDeviceConfig config() {
    SimulatedDeviceConfig loose;
    loose.hand_n_per_m = 30.0;
    loose.hand_n_s_per_m = 4.0;
    loose.resolution_m = 2e-5;
    return loose;
  }

  HandTarget target;
  SimulatedLink link;
  ProbeGuide guide;
  bool goes_along = false;
  std::vector<std::string> said;
  std::vector<double> left_s;
};

TEST(Probe, LeadsAPersonThroughInTwoMinutes) {
  LedHand hand(true);
  const ProbeOptions options{.axes = {0, 1, 2}, .by_hand = true};
  const ProbeReport report = probe(hand.link, options, hand.guide, hand.link.clock);
  ASSERT_EQ(hand.said.size(), 1U + 6U + 1U + 3U);
  EXPECT_EQ(hand.said[0].substr(0, 19), "1 of 4: hold the to");
  EXPECT_EQ(hand.said[2], "2 of 4: move it slowly to the left, as far as it goes");
  EXPECT_EQ(hand.said[7].substr(0, 16), "3 of 4: bring it");
  EXPECT_NEAR((report.highest_m - report.lowest_m).x(), 0.05, 2e-3);
  EXPECT_NEAR((report.highest_m - report.lowest_m).y(), 0.04, 2e-3);
  EXPECT_NE(probe_text(report).find("moved by hand over"), std::string::npos);
  for (const ProbedAxis& axis : report.axis) {
    EXPECT_EQ(axis.failure, "");
    EXPECT_NEAR(axis.mass_kg, 0.12, 0.012);
  }
  EXPECT_LE(hand.link.force_max_n, kProbeForceMaxN);
  const double seconds = static_cast<double>(hand.link.clock.now_ns()) / 1e9;
  EXPECT_LT(seconds, 120.0);
  EXPECT_LT(probe_duration_s(options), 120.0);
  EXPECT_NEAR(hand.left_s.front(), probe_duration_s(options), 1.0);
  EXPECT_TRUE(std::is_sorted(hand.left_s.rbegin(), hand.left_s.rend()));
  EXPECT_LT(hand.left_s.back(), 14.0);
}

TEST(Probe, SeesThatSomebodyHoldsTheTool) {
  for (const double grip_n_per_m : {0.0, 100.0, 300.0}) {
    SimulatedDeviceConfig held = let_go();
    held.hand_n_per_m = grip_n_per_m;
    const HandTarget there;
    SimulatedLink link(held, there);
    link.open();
    std::string why;
    try {
      static_cast<void>(probe(link, {}, {}, link.clock));
    } catch (const DeviceError& error) {
      why = error.what();
    }
    EXPECT_EQ(why.find("somebody holds it") != std::string::npos, grip_n_per_m > 0.0)
        << grip_n_per_m << why;
  }
}

std::string failure_of(SimulatedLink& link, const ProbeOptions& options,
                       const ProbeGuide& guide = {}) {
  link.open();
  try {
    static_cast<void>(probe(link, options, guide, link.clock));
  } catch (const Error& error) {
    EXPECT_EQ(link.sent_n(), Eigen::Vector3d::Zero()) << error.what();
    return error.what();
  }
  return "";
}

TEST(Probe, EndsByNameAndLetsGo) {
  const HandTarget nobody;
  SimulatedDeviceConfig config = let_go();
  config.coulomb_n = 0.5;
  {
    SimulatedLink link(config, nobody);
    EXPECT_NE(failure_of(link, {.rise_n_per_s = 1.0}).find("moved nothing"),
              std::string::npos);
    EXPECT_LE(link.force_max_n, kProbeForceMaxN);
  }
  config.coulomb_n = 0.03;
  {
    SimulatedLink link(config, nobody);
    link.gain = 30.0;  // a driver whose newtons are others
    EXPECT_NE(failure_of(link, {}).find("ran away"), std::string::npos);
  }
  {
    SimulatedLink link(config, nobody);
    link.exchanged = [&link] {
      link.lost = link.clock.now_ns() > 3'000'000'000;
    };
    EXPECT_EQ(failure_of(link, {}), "simulated: gone");
  }
  {
    SimulatedLink link(config, nobody);
    ProbeGuide guide;
    guide.stopped = [&link] {
      return link.force_max_n > 0.1;
    };
    EXPECT_EQ(failure_of(link, {}, guide), "interrupted");
  }
  SimulatedLink link(config, nobody);
  EXPECT_NE(failure_of(link, {.force_n = 0.31}).find("must lie in (0, 0.3]"),
            std::string::npos);
  EXPECT_EQ(link.force_max_n, 0.0);
}

// Through a wire in real time, where delays are counted in exchanges of a millisecond.
void expect_found(const ProbeReport& report, const SimulatedDeviceConfig& made,
                  double resolution_m) {
  const std::string text = probe_text(report);
  const ProbedAxis& found = report.axis.at(0);
  EXPECT_NEAR(found.mass_kg, made.mass_kg, 0.1 * made.mass_kg) << text;
  EXPECT_NEAR(found.friction_n, made.coulomb_n, 0.1 * made.coulomb_n) << text;
  EXPECT_NEAR(report.resolution_m, resolution_m, 0.1 * resolution_m) << text;
  EXPECT_NEAR(found.delay_s, 1e-3 * made.delay_ticks, 1e-4 * made.delay_ticks) << text;
  EXPECT_GT(report.free_rate_hz, 100.0);
}

constexpr int kDelayTicks = 8;
ProbeOptions quick(int axis) {
  return {
      .rise_n_per_s = 0.15, .wire_s = 0.1, .rounds = 1, .pushes = 8, .axes = {axis}};
}

ProbeReport probed_on_time(DeviceLink& link, const ProbeOptions& options) {
  ProbeReport report;
  MonotonicClock clock;
  undisturbed([&] {
    report = probe(link, options, {}, clock);
  });
  return report;
}

TEST(Probe, FindsWhatAnEmulatedInverse3IsLike) {
  Inverse3ModelConfig model{.dynamics = let_go()};
  model.deaf = 0;
  model.dynamics.mass_kg = 0.2;
  model.dynamics.coulomb_n = 0.06;
  model.dynamics.resolution_m = 2e-5;
  model.dynamics.delay_ticks = kDelayTicks;
  Inverse3Config config;
  config.answer_s = 0.05;  // a test machine may pause
  const auto link = EmulatedInverse3::link(
      std::make_shared<EmulatedInverse3>(model, UsbFaults{}), config);
  link->open();
  expect_found(probed_on_time(*link, quick(0)), model.dynamics, 2e-5);
}

TEST(Probe, FindsWhatTheEmulatedInverseServicesDeviceIsLike) {
  EmulatedInverseConfig emulated{.dynamics = let_go()};
  emulated.dynamics.mass_kg = 0.15;
  emulated.dynamics.coulomb_n = 0.05;
  emulated.dynamics.resolution_m = 5e-5;
  emulated.dynamics.delay_ticks = kDelayTicks;
  EmulatedInverse service(emulated);
  InverseConfig config;
  config.port = service.port();
  config.events_port = service.events_port();
  config.answer_s = 0.1;
  InverseLink link(config);
  link.open();
  expect_found(probed_on_time(link, quick(1)), emulated.dynamics, 5e-5);
}

// Whose step is a count of one leg: from the mechanism's geometry where it stands.
TEST(Probe, FindsWhatAnEmulated2diyIsLike) {
  HaplyModelConfig model{.dynamics = let_go()};
  model.dynamics.mass_kg = 0.15;
  model.dynamics.coulomb_n = 0.05;
  model.dynamics.resolution_m = 0.0;
  model.dynamics.delay_ticks = kDelayTicks;
  const auto link = EmulatedHaply::link(
      std::make_shared<EmulatedHaply>(model, UsbFaults{}), HaplyConfig{});
  link->open();
  Eigen::Vector2d theta;
  PantographPose pose;
  ASSERT_TRUE(inverse(model.links, model.start_m.head<2>(), theta));
  ASSERT_TRUE(forward(model.links, theta, pose));
  const double count_rad = 2.0 * std::numbers::pi / HaplySetup{}.counts_per_turn;
  expect_found(probed_on_time(*link, quick(0)), model.dynamics,
               count_rad * pose.jacobian.colwise().norm().minCoeff());
}

TEST(ProbeFile, IsReadAsItWasWritten) {
  const ScratchFolder folder;
  const auto file = folder / "probe.json";
  ProbeReport report = probed(let_go(), {.pushes = 2, .axes = {0, 1}});
  report.axis[1] = {.axis = 2, .failure = "it falls"};
  write_probe(file, report);
  const ProbeReport again = read_probe(file);
  EXPECT_EQ(probe_json(again), probe_json(report));
  EXPECT_EQ(probe_text(again), probe_text(report));
  // Whoever gets it can fit it once more.
  const PushFit fit = fit_pushes(again.axis[0].push, 0.12);
  EXPECT_NEAR(std::max(0.0, fit.delay_s), report.axis[0].delay_s, 2e-6);
}

TEST(ProbeFile, WhatIsNoneIsRefusedByName) {
  const ScratchFolder folder;
  const auto file = folder / "probe.json";
  const std::string good = probe_json(probed(let_go(), {.pushes = 2}));
  const auto refusal = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    std::ofstream(file) << text.replace(at, from.size(), to);
    try {
      static_cast<void>(read_probe(file));
    } catch (const FormatError& error) {
      return std::string(error.what()).substr(file.string().size());
    }
    return std::string();
  };
  EXPECT_EQ(refusal("{", "{"), "");
  EXPECT_NE(refusal("{", "").find("is no probe"), std::string::npos);
  EXPECT_NE(refusal("\"version\":1", "\"version\":2").find("is no probe"),
            std::string::npos);
  EXPECT_NE(refusal("\"mass_kg\":", "\"mass_kg\":-").find("mass_kg is missing or -"),
            std::string::npos);
  EXPECT_NE(refusal("\"delay_s\":", "\"delay_s\":1e9,\"x\":").find("delay_s is"),
            std::string::npos);
  EXPECT_NE(refusal("\"axis\":\"x\"", "\"axis\":\"w\"").find("none of x, y and z"),
            std::string::npos);
  EXPECT_NE(refusal("\"way_nm\":[", "\"way_nm\":[0,").find("way_nm"),
            std::string::npos);
  EXPECT_THROW(static_cast<void>(read_probe(folder / "nowhere")), InputError);
}

}  // namespace
}  // namespace palpate
