// A tool of several contacts on a device that does not turn: the coupled step's
// numbers, the fast process' watch.
#include "runtime/render/several_contacts.h"

#include <memory>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/response/tool_support.h"
#include "tests/support/padded_plate.h"
#include "tests/support/pressed_plate.h"

namespace palpate {
namespace {

class SeveralContactsRun : public testing::Test {
 protected:
  static RenderConfig potential() {
    RenderConfig c = config(LocalModel::kPotential);
    c.fast.fast.force_max_n = 20.0;
    return c;
  }

  RenderReport render(FakeDevice& device, const RenderConfig& c) {
    SeveralContacts body(database_, find_tool(database_, "pads"), c.fast.fast, 1.0);
    trace_.reserve(10'000);
    return render_in_turns(
        c, {.device = device, .stop = stop_, .trace = &trace_, .several = &body},
        clock_);
  }

  ResponseDatabase database_ = padded_plate(3);
  FakeClock clock_{1'000'000};
  std::atomic<bool> stop_ = false;
  std::vector<RenderTick> trace_;
};

TEST_F(SeveralContactsRun, PushesAsTheirEquilibriumDoes) {
  FakeDevice device(clock_, press(0.005, 2.0));
  const RenderReport report = render(device, potential());
  EXPECT_EQ(report.fault, Fault::kNone);
  EXPECT_EQ(report.starved_ticks, 0);
  // f_i = 2e4 delta_i^2, delta_i + sum of c(r_ij) f_j = d: outer pads at 12 and 24 mm,
  // the middle one twice at 12 mm; c = 2e-5 / r, friction at rest along z is none.
  const double d = 0.003;
  double outer = 0.0;
  double middle = 0.0;
  for (int i = 0; i < 200; ++i) {
    const double c = 2e-5 / 0.012;
    const double outer_m = d - c * middle - 0.5 * c * outer;
    const double middle_m = d - 2.0 * c * outer;
    outer += 0.5 * (2e4 * outer_m * outer_m - outer);
    middle += 0.5 * (2e4 * middle_m * middle_m - middle);
  }
  double deepest_n = 0.0;
  for (const RenderTick& tick : trace_) {
    deepest_n = std::max(deepest_n, tick.command.force_n.z());
    EXPECT_LT(tick.command.force_n.head<2>().norm(), 1e-9);
  }
  EXPECT_NEAR(deepest_n, 2.0 * outer + middle, 2e-4 * deepest_n);
  EXPECT_LT(deepest_n, 0.95 * 3.0 * 2e4 * d * d);
  // What came back is what was put in.
  EXPECT_NEAR(report.model_work_j,
              report.stored_j + report.dissipated_j + report.tank_j, 1e-12);
  EXPECT_GE(report.model_work_j, -1e-12);
}

TEST_F(SeveralContactsRun, FaultsAsOneContactDoes) {
  RenderConfig slow = potential();
  slow.slow_hz = 1.0;  // one turn before the contact, the next one comes too late
  slow.fast.stall_fault_s = 0.5;
  FakeDevice stalled(clock_, [](double t) {
    return Eigen::Vector3d(0.0031, 0.0017,
                           kPadRadius + 0.002 - 0.004 * std::min(1.0, t / 0.3));
  });
  const RenderReport late = render(stalled, slow);
  EXPECT_EQ(late.fault, Fault::kSlowStalled);
  EXPECT_NEAR(late.fault_s, 0.5, 0.002);
  EXPECT_GT(late.force_max_n, 0.1);
  EXPECT_EQ(stalled.force.back().norm(), 0.0);

  FakeDevice lost(clock_, press(0.005, 2.0));
  lost.lost_read = 2000;
  EXPECT_EQ(render(lost, potential()).fault, Fault::kDeviceLost);
  EXPECT_GT(lost.force[1999].norm(), 0.1);
  EXPECT_EQ(lost.force.back().norm(), 0.0);

  RenderConfig quick = potential();
  quick.fast.speed_max_m_per_s = 3.0;
  FakeDevice jumps(clock_, [](double t) {
    return Eigen::Vector3d(0.0031, 0.0017, kPadRadius + (t < 0.5 ? 0.01 : -0.002));
  });
  EXPECT_EQ(render(jumps, quick).fault, Fault::kJump);
  EXPECT_EQ(jumps.force.back().norm(), 0.0);
}

TEST_F(SeveralContactsRun, AForceThatTheDeviceWithheldIsNotGivenBack) {
  // Pressed in against nothing, the hand has put no work in: pushed out by the whole
  // force it would get what nobody paid.
  FastConfig config = potential().fast.fast;
  config.energy_floor_j = 1e-4;
  for (const bool withheld : {false, true}) {
    SeveralContacts body(database_, find_tool(database_, "pads"), config, 1.0);
    ArrivalRecord arrival;
    bool touched = false;
    for (std::int64_t tick = 0; tick < 1000; ++tick) {
      const auto steps = static_cast<double>(tick < 500 ? tick : 1000 - tick);
      DeviceReading reading;
      reading.time_ns = tick * 1'000'000;
      reading.position_m = {0.0031, 0.0017, kPadRadius + 0.001 - 1e-5 * steps};
      while (body.take_in(arrival)) {
      }
      (void)body.step(reading, 1e-3);
      touched = touched || (body.in_contact() && body.triangle() >= 0);
      if (withheld && tick < 500) {
        body.delivered(Eigen::Vector3d::Zero());
      }
      body.publish(reading, tick + 1);
      (void)body.serve(reading.time_ns);
    }
    EXPECT_TRUE(touched);
    EXPECT_EQ(body.fault(), withheld ? Fault::kEnergy : Fault::kNone);
  }
}

TEST_F(SeveralContactsRun, RefuseABodyThatHasYielded) {
  SeveralContacts body(database_, find_tool(database_, "pads"), potential().fast.fast,
                       1.0);
  body.begin_with({});
  EXPECT_THROW(body.begin_with({YieldedRow{}}), InputError);
}

}  // namespace
}  // namespace palpate
