#include "runtime/render/render_loop.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/pressed_plate.h"

namespace palpate {
namespace {

class RenderLoop : public PressedPlate {};

TEST_F(RenderLoop, RendersTheCurveAtTheDepthOnAHomogeneousBody) {
  FakeDevice device(clock_, press(0.008, 2.0));
  const RenderReport report = render(device, config(LocalModel::kElement));
  EXPECT_EQ(report.fault, Fault::kNone);
  EXPECT_EQ(report.ticks, 4000);
  const CurveView curve = database_.tools[0].curve(0);
  int compared = 0;
  for (const RenderTick& tick : trace_) {
    const double depth = kRadius - tick.pose[0].position_m.z();
    // Slow enough that neither clamp acts; the first slow update precedes the contact.
    EXPECT_NEAR(tick.command.wrench[0].force_n.z(), curve.at(depth).force_n, 1e-9);
    EXPECT_NEAR(tick.command.wrench[0].force_n.head<2>().norm(), 0.0, 1e-9);
    compared += tick.command.in_contact ? 1 : 0;
  }
  EXPECT_EQ(compared, report.contact_ticks);
  EXPECT_GT(compared, 2000);
  EXPECT_NEAR(report.depth_max_m, 0.006, 1e-6);
}

TEST_F(RenderLoop, CreatesNoEnergyWhenPressingSlidingReleasing) {
  const auto slide = [](double t) -> Eigen::Vector3d {
    const double turn = 2.0 * std::numbers::pi;
    const double depth = 0.004 * (1.0 - std::cos(turn * t / 2.0)) - 0.001;
    return {0.02 * std::sin(turn * t), 0.02 * std::cos(turn * t), kRadius - depth};
  };
  for (const LocalModel model :
       {LocalModel::kEqualEnergy, LocalModel::kEnergyTank, LocalModel::kElement}) {
    FakeDevice device(clock_, slide);
    trace_.clear();
    const RenderReport report = render(device, config(model));
    EXPECT_EQ(report.fault, Fault::kNone) << name(model);
    EXPECT_GT(report.contact_ticks, 2000) << name(model);
    EXPECT_GE(report.model_work_j, -1e-15) << name(model);  // rounding of sums of mJ
    // Holding a force for T creates at most T J v^2 / 2 per unit of time; the largest
    // slope is 2 * 2e4 * 0.007 N/m, that of equal energy up to twice as much.
    double held_j = 0.0;
    for (std::size_t i = 1; i < trace_.size(); ++i) {
      const double step =
          trace_[i].pose[0].position_m.z() - trace_[i - 1].pose[0].position_m.z();
      held_j += 0.5 * 2.0 * 280.0 * step * step;
    }
    EXPECT_GE(report.net_energy_j(), -held_j) << name(model);
    if (model == LocalModel::kElement) {  // it has friction
      EXPECT_GT(report.net_energy_j(), 1e-3);
    }
  }
}

TEST_F(RenderLoop, GivesTheSameBitsTwice) {
  FakeDevice first(clock_, press(0.006, 0.5));
  (void)render(first, config(LocalModel::kEnergyTank));
  FakeDevice second(clock_, press(0.006, 0.5));  // the clock has gone on
  (void)render(second, config(LocalModel::kEnergyTank));
  EXPECT_EQ(first.force, second.force);
}

TEST_F(RenderLoop, CountsDeadlinesThatWereMissedAndGoesOn) {
  clock_.oversleep(100, 1'600'000);  // 3.2 periods of 0.5 ms
  clock_.oversleep(200, 400'000);    // within the period
  FakeDevice device(clock_, press(0.006, 2.0));
  const RenderReport report = render(device, config(LocalModel::kElement));
  EXPECT_EQ(report.missed_deadlines, 3);
  EXPECT_EQ(report.ticks, 4000 - 3);
  EXPECT_EQ(report.fault, Fault::kNone);
}

TEST_F(RenderLoop, CountsALateReadAndKeepsTheLastPosition) {
  FakeDevice device(clock_, press(0.006, 2.0));
  device.late_read = 1500;
  const RenderReport report = render(device, config(LocalModel::kElement));
  EXPECT_EQ(report.late_reads, 1);
  EXPECT_EQ(report.fault, Fault::kNone);
  EXPECT_EQ(trace_[1500].pose[0].position_m, trace_[1499].pose[0].position_m);
}

TEST_F(RenderLoop, EndsWithZeroForceWhenItIsStopped) {
  FakeDevice device(clock_, press(0.006, 2.0));
  device.on_write = [&] {
    stop_.store(device.force.size() == 1500);
  };
  const RenderReport report = render(device, config(LocalModel::kElement));
  EXPECT_TRUE(report.interrupted);
  EXPECT_EQ(report.ticks, 1500);
  EXPECT_GT(device.force[1499].norm(), 0.1);
  EXPECT_EQ(device.force.back().norm(), 0.0);
  EXPECT_FALSE(device.is_open());
}

TEST_F(RenderLoop, DoesNotStartWithoutADevice) {
  FakeDevice device(clock_, press(0.006, 2.0));
  device.absent = true;
  EXPECT_THROW((void)render(device, config(LocalModel::kElement)), DeviceError);
}

TEST_F(RenderLoop, RefusesRatesAndDurationsThatCannotBe) {
  for (const double wrong : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    RenderConfig c = config(LocalModel::kElement);
    c.duration_s = wrong;
    EXPECT_THROW(check(c), InputError) << wrong;
    c = config(LocalModel::kElement);
    c.fast.rate_hz = wrong;
    EXPECT_THROW(check(c), InputError) << wrong;
  }
  RenderConfig c = config(LocalModel::kElement);
  c.slow_hz = 3000.0;
  EXPECT_THROW(check(c), InputError);
}

// Facts that hold whatever the load of the machine: time is not compared.
TEST_F(RenderLoop, RunsOnTwoRealThreads) {
  MonotonicClock clock;
  FakeDevice device(clock, press(0.006, 0.2));
  ElementStream stream(database_, database_.tools[0]);
  RenderConfig c = config(LocalModel::kElement);
  c.duration_s = 0.4;
  c.fast.late_fault_s = 10.0;  // a test machine may pause
  c.fast.stall_fault_s = 10.0;
  const RenderReport report = render_in_real_time(
      c, {.device = device, .stream = &stream, .stop = stop_, .trace = nullptr});
  EXPECT_EQ(report.fault, Fault::kNone);
  EXPECT_GT(report.ticks, 0);
  EXPECT_LE(report.ticks + report.missed_deadlines, 801);
  EXPECT_EQ(report.step_time.count(), static_cast<std::uint64_t>(report.ticks));
  EXPECT_FALSE(report.scheduling.empty());
  EXPECT_EQ(device.closed, 1);
  EXPECT_EQ(device.force.back().norm(), 0.0);
}

}  // namespace
}  // namespace palpate
