// A tool that nobody holds, pushed onto a body by a constant force, behind wires that
// are fast, slow, late and uneven: by the energy that held forces give it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "runtime/render/wire_watch.h"
#include "tests/support/pressed_plate.h"

namespace palpate {
namespace {

constexpr double kBodyNPerM = 119.0;
constexpr double kMassKg = 0.08;
constexpr double kDampingNsPerM = 0.5;
constexpr double kPushN = 0.25;

double linear(Eigen::Index /*node*/, double d) {
  return kBodyNPerM * d;
}

// Says a state every period of its wire; a force acts from when it comes, or, where the
// wire answers late, from the next exchange on, whose position is measured at its
// begin.
class WiredTool : public Device {
 public:
  /// Period [s] of state i.
  using Periods = std::function<double(int)>;

  WiredTool(Clock& clock, Periods periods, bool late)
      : clock_(clock), periods_(std::move(periods)), late_(late) {}

  [[nodiscard]] std::string name() const override { return "wired tool"; }
  [[nodiscard]] DeviceLimits limits() const override {
    return {.damping_n_s_per_m = kDampingNsPerM, .delay_s = 1e-3, .force_max_n = 8.0};
  }
  void open() override {
    begun_ns_ = moved_ns_ = clock_.now_ns();
    next_ns_ = begun_ns_;
  }
  [[nodiscard]] DeviceStatus read(DeviceReading& reading) noexcept override {
    const std::int64_t now_ns = clock_.now_ns();
    move_until(now_ns);
    if (now_ns >= next_ns_) {
      next_ns_ += nanoseconds_in(periods_(states_++));
      if (late_) {
        said_ = begun_;
        acting_n_ = wanted_n_;
        begun_ = here(now_ns);
        said_ = states_ == 1 ? begun_ : said_;
      } else {
        said_ = here(now_ns);
      }
    }
    reading = said_;
    reading.read_ns = now_ns;
    return DeviceStatus::kOk;
  }
  [[nodiscard]] DeviceStatus write(const Eigen::Vector3d& force_n) noexcept override {
    wanted_n_ = force_n.z();
    if (!late_) {
      acting_n_ = wanted_n_;
    }
    return DeviceStatus::kOk;
  }
  void close() noexcept override { acting_n_ = 0.0; }

  double given_max_j = 0.0;  ///< [J] most by the forces since the start

 private:
  [[nodiscard]] DeviceReading here(std::int64_t now_ns) const {
    return {.position_m = {0.0031, 0.0017, kRadius + height_m_}, .time_ns = now_ns};
  }
  void move_until(std::int64_t now_ns) noexcept {
    constexpr std::int64_t kStepNs = 50'000;
    const double h = seconds_in(kStepNs);
    for (; moved_ns_ < now_ns; moved_ns_ += kStepNs) {
      speed_m_per_s_ +=
          h * (acting_n_ - kPushN - kDampingNsPerM * speed_m_per_s_) / kMassKg;
      height_m_ += h * speed_m_per_s_;
      given_j_ += h * acting_n_ * speed_m_per_s_;
      given_max_j = std::max(given_max_j, given_j_);
    }
  }

  Clock& clock_;
  Periods periods_;
  bool late_;
  std::int64_t begun_ns_ = 0, moved_ns_ = 0, next_ns_ = 0;
  int states_ = 0;
  DeviceReading begun_, said_;
  double wanted_n_ = 0.0, acting_n_ = 0.0;
  double height_m_ = 0.004, speed_m_per_s_ = 0.0, given_j_ = 0.0;
};

struct WireCase {
  std::string name;
  WiredTool::Periods periods;
  bool late = false;
};

class SlowWire : public PressedPlate {
 protected:
  RenderReport rendered(const WireCase& wire, double& given_max_j) {
    const ResponseDatabase database = sample_database(
        plate(0.1, 10), ball(kRadius, 0.0, 5e-4), linear, kDepthMax, 41);
    ElementStream stream(database, database.tools[0]);
    FakeClock clock(1'000'000);
    WiredTool tool(clock, wire.periods, wire.late);
    RenderConfig c = config(LocalModel::kPotential);
    c.duration_s = 5.0;
    c.fast.wire = {.damping_n_s_per_m = kDampingNsPerM,
                   .stiffness_n_per_m = kBodyNPerM,
                   .delay_s = 1e-3,
                   .floor_j = c.fast.fast.energy_floor_j};
    const RenderReport report =
        render_in_turns(c, {.device = tool, .stream = &stream, .stop = stop_}, clock);
    given_max_j = tool.given_max_j;
    return report;
  }
};

WiredTool::Periods every(double period_s) {
  return [=](int) {
    return period_s;
  };
}

TEST_F(SlowWire, EndsWithItsNameBeforeTheHandGetsMuch) {
  for (const WireCase& wire :
       {WireCase{"19 ms", every(0.019)}, WireCase{"50 ms", every(0.05)},
        WireCase{"uneven",
                 [](int i) {
                   return 0.003 + 0.036 * std::abs(std::sin(7.0 * i));
                 }},
        WireCase{"6 ms late", every(0.006), true},
        WireCase{"8 ms late", every(0.008), true},
        WireCase{"18 ms late", every(0.018), true},
        WireCase{"slow after a second", [](int i) {
                   return i < 1000 ? 0.001 : 0.025;
                 }}}) {
    double given_max_j = 0.0;
    const RenderReport report = rendered(wire, given_max_j);
    EXPECT_EQ(report.fault, Fault::kSlowWire) << wire.name << " " << given_max_j;
    EXPECT_LE(given_max_j, 0.02) << wire.name;
    EXPECT_GT(report.held_s, 0.005) << wire.name;
  }
}

TEST_F(SlowWire, WithinItsBoundEndsNothing) {
  for (const WireCase& wire :
       {WireCase{"each tick", every(0.0005)}, WireCase{"1 ms", every(0.001)},
        WireCase{"1 ms late", every(0.001), true}, WireCase{"6 ms", every(0.006)},
        WireCase{"busy for 50 ms",
                 [](int i) {
                   return i % 1000 == 300 ? 0.05 : 0.001;
                 }},
        WireCase{"one of fifty late",
                 [](int i) {
                   return i % 50 == 49 ? 0.018 : 0.001;
                 }},
        WireCase{"uneven", [](int i) {
                   return 0.0005 + 0.005 * std::abs(std::sin(7.0 * i));
                 }}}) {
    double given_max_j = 0.0;
    const RenderReport report = rendered(wire, given_max_j);
    EXPECT_EQ(report.fault, Fault::kNone) << wire.name;
    EXPECT_LE(given_max_j, 0.02) << wire.name;
    EXPECT_GT(report.contact_ticks, 1000) << wire.name;
  }
}

// A hand that is moved by 0.1 mm a millisecond, or moves.
class WatchedWire : public testing::Test {
 protected:
  // Force and movement along z [N, m], what the model could give back [J].
  void move(double force_n, double moved_m, double available_j,
            std::int64_t took_ns = kMs) {
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    watch_.hold(now_ns_, force_n * up);
    watch_.move({.from_ns = now_ns_,
                 .to_ns = now_ns_ + took_ns,
                 .read_ns = now_ns_ + took_ns,
                 .moved_m = moved_m * up},
                available_j);
    now_ns_ += took_ns;
  }
  static constexpr std::int64_t kMs = 1'000'000;
  WireWatch watch_{{.damping_n_s_per_m = 0.5, .stiffness_n_per_m = 100.0}};
  std::int64_t now_ns_ = kMs;
};

// Which the mechanism, as its driver says, ought to have taken: each time 0.1 mJ, less
// 5 uJ of damping and 2 uJ of the hand, after one that begins.
TEST_F(WatchedWire, EnergyThatAFastWireGivesHasAnotherName) {
  for (int i = 0; i < 108; ++i) {
    move(1.0, 1e-4, 0.0);
  }
  EXPECT_EQ(watch_.fault(true), Fault::kNone);
  move(1.0, 1e-4, 0.0);
  EXPECT_EQ(watch_.fault(true), Fault::kEnergy);
}

// What friction took, and what the model has forgotten, is not lent: 2 mJ and the floor
// of 10 mJ, by 1 mJ less 0.502 mJ each, and one over.
TEST_F(WatchedWire, LendsNothingOfWhatAHandPutInBefore) {
  for (int i = 0; i < 1000; ++i) {
    move(1.0, -1e-3, 0.002);
  }
  int ticks = 0;
  for (; watch_.fault(true) == Fault::kNone && ticks < 1000; ++ticks) {
    move(1.0, 1e-3, 0.002);
  }
  EXPECT_EQ(ticks, 25);
}

// 1 ms for a second, then 10 ms for 50 ms: by a share of 1 - 1/e nearer.
TEST_F(WatchedWire, IsLookedAtFor50Ms) {
  for (int i = 0; i < 1000; ++i) {
    move(0.0, 0.0, 0.0);
  }
  EXPECT_NEAR(watch_.held_s(), 0.001, 1e-9);
  for (int i = 0; i < 5; ++i) {
    move(0.0, 0.0, 0.0, 10 * kMs);
  }
  EXPECT_NEAR(watch_.held_s(), 0.010 - 0.009 * std::exp(-1.0), 1e-9);
}

// While a tool flies its mechanism takes what it was given, and pays for no other
// throw.
TEST_F(WatchedWire, DampingWithoutAForcePaysForNothing) {
  for (int i = 0; i < 100; ++i) {
    move(1.0, 1e-4, 0.0);
    move(0.0, 1e-3, 0.0);
  }
  EXPECT_EQ(watch_.fault(true), Fault::kNone);
  for (int i = 0; i < 20; ++i) {
    move(1.0, 1e-4, 0.0);
    move(0.0, 1e-3, 0.0);
  }
  EXPECT_EQ(watch_.fault(true), Fault::kEnergy);
}

}  // namespace
}  // namespace palpate
