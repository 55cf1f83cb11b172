// A grip that turns, from the service to the force: the tool's pose is the grip's, and
// what pushes back is the turned tool's.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/attach/device_choice.h"
#include "runtime/inverse/emulated_inverse.h"
#include "runtime/inverse/inverse_link.h"
#include "runtime/render/several_contacts.h"
#include "runtime/run/render_run.h"
#include "tests/support/padded_plate.h"
#include "tests/support/undisturbed.h"

namespace palpate {
namespace {

constexpr double kTiltRad = 0.08;

// While the tool is on its way, and well after the driver began: about an axis of the
// device, and the body's y axis, which is its -z.
Eigen::Quaterniond tilted(double time_s) {
  return Eigen::Quaterniond(
      Eigen::AngleAxisd(kTiltRad * std::clamp((time_s - 0.2) / 0.3, 0.0, 1.0),
                        -Eigen::Vector3d::UnitZ()));
}

AttachedDevice grip_that_tilts() {
  return attach_driven(InverseLink({}).limits(), inverse_rest_m(), [](HandScript hand) {
    hand.circle_m = 0.0;  // pressed from 1.2 to 2.6 s
    EmulatedInverseConfig config;
    config.hand = hand;
    config.start_m = hand.at(0.0).position_m;
    config.grip_turn = tilted;
    const auto service = std::make_shared<EmulatedInverse>(config);
    const auto bin = std::filesystem::read_symlink("/proc/self/exe").parent_path();
    return DriverProgram{
        .name = "haply-inverse",
        .command = {(bin / "palpate-run").string(), "driver", "--device",
                    "haply-inverse:" + std::to_string(service->port()), "--events-port",
                    std::to_string(service->events_port()), "--no-sign-test"},
        .kept = service};
  });
}

// [N] on the tool after it came straight down to a place, turned as it is there.
Eigen::Vector3d force_at(const ResponseDatabase& database, double force_scale,
                         const Eigen::Vector3d& position_m,
                         const Eigen::Quaterniond& turn) {
  FastConfig fast;
  fast.model = LocalModel::kPotential;
  const ResponseTable* const pads[] = {&find_tool(database, "pads")};
  SeveralContacts body(database, pads, fast, {.force_scale = force_scale});
  ArrivalRecord arrival;
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  constexpr int kTicks = 1000;
  for (int tick = 0; tick <= kTicks; ++tick) {
    DeviceReading reading;
    reading.time_ns = std::int64_t{1'000'000} * tick;
    reading.position_m = position_m + 1e-5 * (kTicks - tick) * Eigen::Vector3d::UnitZ();
    reading.turn = turn;
    while (body.take_in(arrival)) {
    }
    force_n = body.step({reading}, 1e-3).wrench[0].force_n;
    body.publish({reading}, tick + 1);
    static_cast<void>(body.serve(reading.time_ns));
  }
  EXPECT_EQ(body.fault(), Fault::kNone);
  return force_n;
}

TEST(TurnedGrip, TurnsTheToolAndItsForceIsThatOfTheTurnedTool) {
  const ResponseDatabase database = padded_plate(3);
  ContactsWatch watch;
  SimulationOptions options;
  options.tool = "pads";
  options.duration_s = 1.6;
  options.fast_hz = 1000.0;
  options.real_time = true;
  options.limit_stiffness = true;
  options.watch_contacts = &watch;
  const std::atomic<bool> stop = false;
  SimulationReport report;
  undisturbed([&] {
    options.attached = grip_that_tilts();
    report = simulate(database, options, stop);
  });
  ASSERT_EQ(report.render.fault, Fault::kNone) << report.device_failure;
  EXPECT_TRUE(report.device_turns);
  EXPECT_NE(summary(report).find("the grip turns the tool; no motor turns it back"),
            std::string::npos)
      << summary(report);
  ASSERT_TRUE(watch.fetch());
  const ContactsSeen& seen = watch.latest();
  const Eigen::Quaterniond turn(seen.hand[0].tool.rotation);
  EXPECT_LT(turn.angularDistance(Eigen::Quaterniond(
                Eigen::AngleAxisd(kTiltRad, Eigen::Vector3d::UnitY()))),
            1e-6);  // single precision
  const auto normal_n = [&](const Eigen::Quaterniond& as) {
    return force_at(database, report.force_scale, seen.hand[0].tool.position_m, as).z();
  };
  const double turned_n = normal_n(turn);
  EXPECT_GT(turned_n, 0.1);
  // Friction of the pads, on a slope of 0.08: 0.3 * 0.08.
  EXPECT_NEAR(seen.hand[0].wrench.force_n.z() / turned_n, 1.0, 0.03);
  EXPECT_GT(std::abs(normal_n(Eigen::Quaterniond::Identity()) / turned_n - 1.0), 0.06);
}

}  // namespace
}  // namespace palpate
