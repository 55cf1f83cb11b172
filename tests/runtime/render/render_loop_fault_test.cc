// What the render loop does when something fails, or cannot be.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "runtime/render/render_loop.h"
#include "tests/support/pressed_plate.h"

namespace palpate {
namespace {

class RenderLoopFault : public PressedPlate {};

TEST_F(RenderLoopFault, EndsWithZeroForceOnABurstOfMissedDeadlines) {
  clock_.oversleep(2000, 300'000'000);
  FakeDevice device(clock_, press(0.006, 2.0));
  const RenderReport report = render(device, config(LocalModel::kElement));
  EXPECT_EQ(report.fault, Fault::kDeadlines);
  EXPECT_GT(device.force[1999].norm(), 0.1);
  EXPECT_EQ(device.force[2000].norm(), 0.0);
  EXPECT_EQ(device.closed, 1);
}

TEST_F(RenderLoopFault, FaultsWhenTheSlowProcessStallsInContact) {
  RenderConfig c = config(LocalModel::kElement);
  c.slow_hz = 1.0;  // one element a second
  c.fast.stall_s = 0.05;
  c.fast.stall_fault_s = 0.3;
  FakeDevice device(clock_, [](double) {
    return Eigen::Vector3d(0.0031, 0.0017, kRadius - 0.002);
  });
  const RenderReport report = render(device, c);
  EXPECT_EQ(report.fault, Fault::kSlowStalled);
  EXPECT_EQ(report.slow_stalls, 1);
  EXPECT_NEAR(report.fault_s, 0.3, 0.002);
}

TEST_F(RenderLoopFault, StopsAtALostDeviceAndNamesIt) {
  for (const bool at_write : {false, true}) {
    FakeDevice device(clock_, press(0.006, 2.0));
    (at_write ? device.lost_write : device.lost_read) = 1000;
    const RenderReport report = render(device, config(LocalModel::kElement));
    EXPECT_EQ(report.fault, Fault::kDeviceLost);
    EXPECT_EQ(report.ticks, 1001);
    EXPECT_FALSE(device.is_open());
    EXPECT_EQ(device.force.back().norm(), 0.0);
  }
}

TEST_F(RenderLoopFault, FaultsAndStaysFiniteOnAPositionThatIsNoNumber) {
  for (const double wrong : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    const auto script = press(0.006, 2.0);
    FakeDevice device(clock_, [&](double t) -> Eigen::Vector3d {
      return t < 0.7 ? script(t) : Eigen::Vector3d(0.0, wrong, 0.0);
    });
    trace_.clear();
    const RenderReport report = render(device, config(LocalModel::kElement));
    EXPECT_EQ(report.fault, Fault::kNotFinite);
    EXPECT_NEAR(report.fault_s, 0.7, 1e-3);
    EXPECT_GT(device.force[1390].norm(), 0.1);
    EXPECT_EQ(device.force[1400].norm(), 0.0);
    EXPECT_TRUE(std::isfinite(report.net_energy_j()));
    EXPECT_TRUE(std::isfinite(report.model_work_j));
  }
}

TEST_F(RenderLoopFault, AJumpInOneReadingIsAFaultAndNoForce) {
  for (const double jump_m : {0.0005, 0.005}) {
    const auto script = press(0.006, 2.0);
    FakeDevice device(clock_, [&](double t) -> Eigen::Vector3d {
      const bool wrong = std::abs(t - 0.1) < 0.0002;  // before the tool touches
      return script(t) - (wrong ? jump_m : 0.0) * Eigen::Vector3d::UnitZ();
    });
    RenderConfig c = config(LocalModel::kElement);
    c.fast.speed_max_m_per_s = 3.0;
    const RenderReport report = render(device, c);
    EXPECT_EQ(report.fault, jump_m > 0.003 ? Fault::kJump : Fault::kNone) << jump_m;
    if (report.fault == Fault::kJump) {
      EXPECT_NEAR(report.fault_s, 0.1, 2e-3);
      EXPECT_EQ(report.force_max_n, 0.0);
    }
  }
}

// Motors that give nothing on the way in, and all on the way out: the hand would get
// the energy of the press for nothing, again and again.
TEST_F(RenderLoopFault, WhatTheDriverWithholdsIsInTheAccount) {
  class WithholdingDevice : public FakeDevice {
   public:
    using FakeDevice::FakeDevice;
    [[nodiscard]] DeviceStatus read(DeviceReading& reading) noexcept override {
      const DeviceStatus status = FakeDevice::read(reading);
      const bool deeper = reading.position_m.z() < last_z_;
      last_z_ = reading.position_m.z();
      if (deeper && !force.empty()) {
        reading.withheld_n = force.back();
      }
      return status;
    }

   private:
    double last_z_ = 1.0;
  };
  RenderConfig c = config(LocalModel::kElement);
  c.duration_s = 12.0;  // 23 taps of 0.8 mJ, of which ten and some are the floor
  const auto taps = [](double t) {
    return Eigen::Vector3d(0.0031, 0.0017,
                           kRadius + 0.001 - 0.006 * std::abs(std::sin(6.0 * t)));
  };
  FakeDevice honest(clock_, taps);
  EXPECT_EQ(render(honest, c).fault, Fault::kNone);
  WithholdingDevice withholding(clock_, taps);
  const RenderReport report = render(withholding, c);
  EXPECT_EQ(report.fault, Fault::kEnergy);
  EXPECT_NEAR(report.fault_s, 6.5, 2.0);
}

TEST_F(RenderLoopFault, FaultsWhenTimeRunsBackwards) {
  FakeDevice device(clock_, press(0.006, 2.0));
  device.on_read = [](std::size_t number, std::int64_t& time_ns) {
    time_ns -= number == 1500 ? 1'000'000 : 0;
  };
  const RenderReport report = render(device, config(LocalModel::kElement));
  EXPECT_EQ(report.fault, Fault::kTimeStep);
  EXPECT_EQ(report.ticks, 1501);
  EXPECT_EQ(device.force[1500].norm(), 0.0);
}

TEST_F(RenderLoopFault, LeavesTheForceWhereTimeStandsStill) {
  FakeDevice device(clock_, press(0.006, 2.0));
  device.on_read = [](std::size_t number, std::int64_t& time_ns) {
    time_ns -= number == 1500 ? 500'000 : 0;  // the time of the tick before
  };
  const RenderReport report = render(device, config(LocalModel::kElement));
  EXPECT_EQ(report.fault, Fault::kNone);
  EXPECT_EQ(device.force[1500], device.force[1499]);
}

TEST_F(RenderLoopFault, TakesAStepOfOneSecondButNoLongerOne) {
  for (const std::int64_t late_ns : {999'000'000, 1'001'000'000}) {
    FakeClock clock(1'000'000);
    clock.oversleep(1400, late_ns);
    FakeDevice device(clock, press(0.006, 2.0));
    ElementStream stream(database_, database_.tools[0]);
    RenderConfig c = config(LocalModel::kElement);
    c.duration_s = 3.0;
    c.fast.late_fault_s = c.fast.stall_fault_s = 10.0;
    const RenderReport report =
        render_in_turns(c, {.device = device, .stream = &stream, .stop = stop_}, clock);
    const bool longer = late_ns > 1'000'000'000;
    EXPECT_EQ(report.fault, longer ? Fault::kTimeStep : Fault::kNone) << late_ns;
    EXPECT_GE(report.model_work_j, -1e-15);
  }
}

TEST_F(RenderLoopFault, FaultsWhenTheDeviceStaysSilent) {
  FakeDevice device(clock_, press(0.006, 2.0));
  device.silent_from = 1500;
  RenderConfig c = config(LocalModel::kElement);
  c.fast.silent_fault_s = 0.05;
  const RenderReport report = render(device, c);
  EXPECT_EQ(report.fault, Fault::kDeviceSilent);
  EXPECT_EQ(report.late_reads, 101);  // a tick more than 0.05 s
  EXPECT_EQ(device.force.back().norm(), 0.0);
}

// A machine that stood still for 0.2 s, device and renderer alike.
TEST_F(RenderLoopFault, TicksThatItMissedItselfAreNoSilenceOfTheDevice) {
  for (const bool answers : {true, false}) {
    ElementStream stream(database_, database_.tools[0]);
    FakeClock clock(1'000'000);
    clock.oversleep(1500, 200'000'000);
    FakeDevice device(clock, press(0.006, 2.0));
    (answers ? device.late_read : device.silent_from) = 1501;
    const RenderReport report =
        render_in_turns(config(LocalModel::kElement),
                        {.device = device, .stream = &stream, .stop = stop_}, clock);
    EXPECT_EQ(report.fault, answers ? Fault::kNone : Fault::kDeviceSilent);
    EXPECT_EQ(report.late_reads, answers ? 1 : 201);  // a tick more than 0.1 s
  }
}

TEST_F(RenderLoopFault, AClockThatStandsStillIsADeviceThatIsSilent) {
  FakeDevice device(clock_, press(0.006, 2.0));
  std::int64_t stood_ns = 0;
  device.on_read = [&](std::size_t number, std::int64_t& time_ns) {
    stood_ns = number == 1500 ? time_ns : stood_ns;
    time_ns = number > 1500 ? stood_ns : time_ns;
  };
  RenderConfig c = config(LocalModel::kElement);
  c.fast.silent_fault_s = 0.05;
  const RenderReport report = render(device, c);
  EXPECT_EQ(report.fault, Fault::kDeviceSilent);
  EXPECT_EQ(report.ticks, 1602);
  EXPECT_EQ(device.force.back().norm(), 0.0);
}

// Every model that is passive stays so, at 10 m/s down, up and sideways, and when the
// sensor jumps by a metre for one tick.
TEST_F(RenderLoopFault, StaysPassiveAndBoundedAtTenMetresPerSecondAndThroughTeleports) {
  const auto wild = [](double t) -> Eigen::Vector3d {
    const auto tick = static_cast<std::int64_t>(std::llround(t * 2000.0));
    if (tick % 701 == 700) {
      return {0.0, 0.0, -1.0};
    }
    // 5 mm a tick: 10 m/s.
    const double down = static_cast<double>(tick % 4 < 2 ? tick % 4 : 4 - tick % 4);
    const double side = static_cast<double>(tick % 12 < 6 ? tick % 12 : 12 - tick % 12);
    return {0.005 * side - 0.015, 0.0017, kRadius + 0.002 - 0.005 * down};
  };
  for (const LocalModel model :
       {LocalModel::kEqualEnergy, LocalModel::kEnergyTank, LocalModel::kElement}) {
    FakeDevice device(clock_, wild);
    RenderConfig c = config(model);
    c.fast.fast.energy_floor_j = HUGE_VAL;  // the lag of the clamps is real here
    const RenderReport report = render(device, c);
    EXPECT_EQ(report.fault, Fault::kNone) << name(model);
    EXPECT_GE(report.model_work_j, -1e-12) << name(model);
    EXPECT_LE(report.force_max_n, c.fast.fast.force_max_n * (1.0 + 1e-12));
    for (std::size_t i = 1; i < device.force.size() - 1; ++i) {
      ASSERT_TRUE(device.force[i].allFinite());
      // 5000 N/s for half a millisecond.
      ASSERT_LE((device.force[i] - device.force[i - 1]).norm(), 2.5 * (1.0 + 1e-9));
    }
  }
}

TEST_F(RenderLoopFault, CallsTheEnergyThatTheSlewClampCreatesAFault) {
  // Down to 10 mm at 0.2 m/s, up again at 2 m/s: the force is still 1.5 N of 2 when the
  // body has let go, and it pushes on.
  const auto flee = [](double t) -> Eigen::Vector3d {
    const double tick = t * 2000.0;
    const double down = std::clamp(1e-4 * (tick - 200.0), -0.002, 0.01);
    const double up = std::max(0.0, 1e-3 * (tick - 400.0));
    return {0.0031, 0.0017, kRadius - down + up};
  };
  FakeDevice device(clock_, flee);
  RenderConfig c = config(LocalModel::kElement);
  c.fast.fast.slew_max_n_per_s = 100.0;
  const RenderReport report = render(device, c);
  EXPECT_EQ(report.fault, Fault::kEnergy);
  EXPECT_GT(report.ticks, 400);
  EXPECT_GT(device.force[static_cast<std::size_t>(report.ticks) - 2].norm(), 1.0);
  EXPECT_EQ(device.force.back().norm(), 0.0);
}

// Sends as another sender does, until it fails.
class FailingSender : public ElementSender {
 public:
  FailingSender(ElementSender& sender, std::int64_t good)
      : sender_(sender), good_(good) {}
  std::size_t update(const ToolState& tool, std::int64_t now_ns,
                     ElementFifo& fifo) override {
    if (good_-- <= 0) {
      throw FormatError("chunk 7 is damaged");
    }
    return sender_.update(tool, now_ns, fifo);
  }

 private:
  ElementSender& sender_;
  std::int64_t good_;
};

TEST_F(RenderLoopFault, GoesOnWithTheElementItHasWhenTheSlowProcessThrows) {
  FakeDevice device(clock_, press(0.008, 2.0));
  ElementStream stream(database_, database_.tools[0]);
  FailingSender failing(stream, 40);  // 0.4 s: before the contact
  RenderConfig c = config(LocalModel::kElement);
  c.fast.stall_fault_s = 10.0;
  trace_.reserve(10'000);
  const RenderReport report = render_in_turns(
      c, {.device = device, .stream = &failing, .stop = stop_, .trace = &trace_},
      clock_);
  EXPECT_EQ(report.fault, Fault::kNone);
  EXPECT_EQ(report.slow_failure, "chunk 7 is damaged");
  EXPECT_EQ(report.slow_updates, 40);
  EXPECT_EQ(report.slow_stalls, 1);
  const CurveView curve = database_.tools[0].curve(0);
  for (const RenderTick& tick : trace_) {
    const double depth = kRadius - tick.pose[0].position_m.z();
    EXPECT_NEAR(tick.command.wrench[0].force_n.z(), curve.at(depth).force_n, 1e-9);
  }
  EXPECT_GT(report.force_max_n, 0.5);
}

TEST_F(RenderLoopFault, IsStoppedByItsWatchWhenTheSlowProcessThrewInContact) {
  FakeDevice device(clock_, press(0.008, 2.0));
  ElementStream stream(database_, database_.tools[0]);
  FailingSender failing(stream, 70);
  const RenderReport report =
      render_in_turns(config(LocalModel::kElement),
                      {.device = device, .stream = &failing, .stop = stop_}, clock_);
  EXPECT_EQ(report.fault, Fault::kSlowStalled);
  EXPECT_EQ(report.slow_failure, "chunk 7 is damaged");
}

TEST_F(RenderLoopFault, RecordsTheTicksBeforeAFaultForTheFlight) {
  FakeDevice device(clock_, press(0.006, 2.0));
  device.lost_read = 3000;
  ElementStream stream(database_, database_.tools[0]);
  FlightLog flight;
  const RenderReport report = render_in_turns(
      config(LocalModel::kElement),
      {.device = device, .stream = &stream, .stop = stop_, .flight = &flight}, clock_);
  EXPECT_EQ(report.fault, Fault::kDeviceLost);
  const std::vector<TickRecord> ticks = flight.ticks.values();
  ASSERT_EQ(ticks.size(), 3001U);
  EXPECT_EQ(ticks.back().tick, 3000);
  EXPECT_EQ(ticks.back().raised, static_cast<std::uint8_t>(Fault::kDeviceLost));
  EXPECT_EQ(ticks[1500].force_n[2], device.force[1500].z());
  EXPECT_FALSE(flight.arrivals.values().empty());
}

TEST(DeviceSession, EndsWithZeroForceWhenAnExceptionPassesBy) {
  FakeClock clock;
  FakeDevice device(clock, press(0.006, 2.0));
  try {
    const DeviceSession session(device);
    (void)device.write({0.0, 0.0, 1.0});
    throw NumericalError("on the way out");
  } catch (const NumericalError&) {
  }
  EXPECT_EQ(device.closed, 1);
  EXPECT_EQ(device.force.back().norm(), 0.0);
}

// Sends, but not in time.
class LateSender : public ElementSender {
 public:
  explicit LateSender(ElementSender& sender) : sender_(sender) {}
  std::size_t update(const ToolState& tool, std::int64_t now_ns,
                     ElementFifo& fifo) override {
    if (++updates_ == 3) {
      std::this_thread::sleep_for(std::chrono::milliseconds(150));
    }
    return sender_.update(tool, now_ns, fifo);
  }

 private:
  ElementSender& sender_;
  int updates_ = 0;
};

TEST_F(RenderLoopFault, GoesOnInRealTimeWhileTheSlowThreadIsLateOrGone) {
  MonotonicClock clock;
  ElementStream stream(database_, database_.tools[0]);
  LateSender late(stream);
  FailingSender failing(stream, 3);
  for (ElementSender* sender : std::initializer_list<ElementSender*>{&late, &failing}) {
    FakeDevice device(clock, press(0.006, 0.2));
    RenderConfig c = config(LocalModel::kElement);
    c.duration_s = 0.6;
    c.fast.late_fault_s = c.fast.stall_fault_s = 10.0;
    const RenderReport report =
        render_in_real_time(c, {.device = device, .stream = sender, .stop = stop_});
    EXPECT_EQ(report.fault, Fault::kNone);
    EXPECT_LE(report.ticks + report.missed_deadlines, 1201);
    EXPECT_EQ(report.slow_failure, sender == &late ? "" : "chunk 7 is damaged");
    if (sender == &late) {
      EXPECT_GE(report.slow_missed_deadlines, 14);
    }
    EXPECT_EQ(device.force.back().norm(), 0.0);
  }
}

}  // namespace
}  // namespace palpate
