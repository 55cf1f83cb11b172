// A tool of several contacts on a device that does not turn: the coupled step's
// numbers, the fast process' watch.
#include "runtime/render/several_contacts.h"

#include <memory>
#include <vector>

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

  RenderReport render(FakeDevice& device, const RenderConfig& c,
                      const std::optional<VirtualCoupling>& coupling = {}) {
    SeveralContacts body(database_, pads_, c.fast.fast,
                         {.coupling = coupling, .watch = &watch_});
    trace_.clear();
    trace_.reserve(10'000);
    return render_in_turns(
        c, {.device = device, .stop = stop_, .trace = &trace_, .several = &body},
        clock_);
  }

  ResponseDatabase database_ = padded_plate(3);
  std::vector<const ResponseTable*> pads_{&find_tool(database_, "pads")};
  FakeClock clock_{1'000'000};
  std::atomic<bool> stop_ = false;
  std::vector<RenderTick> trace_;
  ContactsWatch watch_;
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
    deepest_n = std::max(deepest_n, tick.command.wrench[0].force_n.z());
    EXPECT_LT(tick.command.wrench[0].force_n.head<2>().norm(), 1e-9);
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
    SeveralContacts body(database_, pads_, config);
    ArrivalRecord arrival;
    bool touched = false;
    for (std::int64_t tick = 0; tick < 1000; ++tick) {
      const auto steps = static_cast<double>(tick < 500 ? tick : 1000 - tick);
      DeviceReading reading;
      reading.time_ns = tick * 1'000'000;
      reading.position_m = {0.0031, 0.0017, kPadRadius + 0.001 - 1e-5 * steps};
      while (body.take_in(arrival)) {
      }
      (void)body.step({reading}, 1e-3);
      touched = touched || (body.in_contact() && body.triangle() >= 0);
      if (withheld && tick < 500) {
        body.delivered(PortWrenches{});
      }
      body.publish({reading}, tick + 1);
      (void)body.serve(reading.time_ns);
    }
    EXPECT_TRUE(touched);
    EXPECT_EQ(body.fault(), withheld ? Fault::kEnergy : Fault::kNone);
  }
}

// The account of a run of 4 s whose forces are those of springs at most.
TEST_F(SeveralContactsRun, HungByACouplingAreSofter) {
  VirtualCoupling soft;
  soft.spring_n_per_m = 150.0;
  FakeDevice stiff(clock_, press(0.005, 2.0));
  const RenderReport held = render(stiff, potential());
  EXPECT_FALSE(held.coupling);
  FakeDevice device(clock_, press(0.005, 2.0));
  const RenderReport hung = render(device, potential(), soft);
  EXPECT_EQ(hung.fault, Fault::kNone);
  ASSERT_TRUE(hung.coupling);
  // 3 mm deep: a spring in series, and dampers that the tool drags along.
  const double damper_n = soft.damper_n_s_per_m * 0.005 * std::numbers::pi / 2.0;
  EXPECT_LT(hung.force_max_n, 0.003 * soft.spring_n_per_m + damper_n);
  EXPECT_GT(hung.force_max_n, 0.3 * 0.003 * soft.spring_n_per_m);
  EXPECT_LT(hung.force_max_n, 0.9 * held.force_max_n);
  EXPECT_NEAR(hung.model_work_j, hung.stored_j + hung.dissipated_j + hung.tank_j,
              1e-12);
  EXPECT_GT(hung.coupling->dissipated_j, 0.0);
  EXPECT_LT(hung.coupling->residual_j, 1e-12);
  EXPECT_GE(hung.net_energy_j(), 0.0);
  // Who looks on sees where tool and device are.
  ASSERT_TRUE(watch_.fetch());
  EXPECT_TRUE(watch_.latest().held);
  EXPECT_EQ(watch_.latest().count, 3);
  EXPECT_EQ(watch_.latest().hand[0].wrench.force_n,
            trace_.back().command.wrench[0].force_n);
}

// A device that measures its turns and cannot push against them: the pads press as they
// stand, and nobody gains by turning them back and forth while they press.
TEST_F(SeveralContactsRun, TurnWithADeviceThatMeasuresIt) {
  const auto tilt = [](double t) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(
        0.08 * std::sin(2.0 * std::numbers::pi * t), Eigen::Vector3d::UnitY()));
  };
  FakeDevice flat(clock_, press(0.005, 2.0));
  const RenderReport upright = render(flat, potential());
  for (const bool hung : {false, true}) {
    FakeDevice device(clock_, press(0.005, 2.0));
    device.turned = tilt;
    const RenderReport report = render(
        device, potential(), hung ? std::optional(VirtualCoupling{}) : std::nullopt);
    EXPECT_EQ(report.fault, Fault::kNone);
    ASSERT_TRUE(watch_.fetch());
    EXPECT_LT(watch_.latest().hand[0].device.rotation(0, 0), 1.0);
    EXPECT_NEAR(report.model_work_j,
                report.stored_j + report.dissipated_j + report.tank_j, 1e-12);
    EXPECT_GE(report.model_work_j, -1e-12);
    // A held spring leaks k dx^2 / 2 a tick, of a sine of 2.5 mm in two seconds.
    const double dx_m = 0.0025 * std::numbers::pi / 2000.0;
    const double leaked_j =
        0.5 * VirtualCoupling{}.spring_n_per_m * 0.5 * dx_m * dx_m * 4000.0;
    EXPECT_GE(report.net_energy_j(), hung ? -1.1 * leaked_j : -1e-6);
    EXPECT_GT(std::abs(report.force_max_n / upright.force_max_n - 1.0), 1e-3);
  }
}

// Half a radian in a millisecond is a sensor's, not a wrist's.
TEST_F(SeveralContactsRun, AnOrientationThatJumpsIsAFault) {
  for (const bool hung : {false, true}) {
    FakeDevice device(clock_, press(0.005, 2.0));
    device.turned = [](double t) {
      return Eigen::Quaterniond(
          Eigen::AngleAxisd(t < 0.7 ? 0.0 : 0.5, Eigen::Vector3d::UnitZ()));
    };
    const RenderReport report = render(
        device, potential(), hung ? std::optional(VirtualCoupling{}) : std::nullopt);
    EXPECT_EQ(report.fault, Fault::kJump);
    EXPECT_NEAR(report.fault_s, 0.7, 0.01);
    EXPECT_EQ(device.force.back(), Eigen::Vector3d::Zero());
  }
}

TEST_F(SeveralContactsRun, RefuseACouplingThatIsNotValid) {
  VirtualCoupling bad;
  bad.mass_kg = -1.0;
  FakeDevice device(clock_, press(0.005, 2.0));
  EXPECT_THROW((void)render(device, potential(), bad), InputError);
}

// A new run on the same body: all but what has yielded is forgotten.
TEST_F(SeveralContactsRun, KeepWhatHasYielded) {
  SeveralContacts body(database_, pads_, potential().fast.fast);
  const KeptSurface rows{.yielded = {{3, 1e-4, 0.0, 0}, {9, 0.0, 2e-4, 0}}};
  body.begin_with(rows);
  EXPECT_EQ(body.kept(), rows);
  body.restart();
  EXPECT_EQ(body.kept(), rows);
  body.begin_with({});
  EXPECT_TRUE(body.kept().empty());
  // More than there is room for: nothing changes.
  body.begin_with(rows);
  KeptSurface many;
  for (std::int32_t site = 0; site <= kYieldedSites; ++site) {
    many.yielded.push_back({site, 1e-4, 0.0, 0});
  }
  EXPECT_THROW(body.begin_with(many), InputError);
  EXPECT_THROW(body.begin_with({.yielded = {{3, 1e-4, 0.0, 1}}}),
               InputError);  // of one table
  EXPECT_THROW(body.begin_with({.channels = {ChannelRow{}}}), InputError);
  EXPECT_EQ(body.kept(), rows);
}

// What the slow process had sent is sent at once again.
TEST_F(SeveralContactsRun, BeginAnewWithoutWaitingForTheirTurn) {
  SeveralContacts body(database_, pads_, potential().fast.fast);
  const HandReadings high{{{.position_m = {0.0, 0.0, 0.02}}}};
  const auto arrived = [&] {
    body.publish(high, 0);
    static_cast<void>(body.serve(0));
    int elements = 0;
    for (ArrivalRecord arrival; body.take_in(arrival);) {
      ++elements;
    }
    return elements;
  };
  const int first = arrived();
  EXPECT_LT(arrived(), first);
  body.restart();
  EXPECT_EQ(arrived(), first);
}

}  // namespace
}  // namespace palpate
