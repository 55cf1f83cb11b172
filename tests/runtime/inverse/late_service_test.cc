// A service that answers late, with real sockets and a real driver: what its forces
// give the tool, and by which name the run ends.
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "runtime/attach/driven_devices.h"
#include "runtime/bench/cylinder_body.h"
#include "runtime/inverse/emulated_inverse.h"
#include "runtime/run/render_run.h"

namespace palpate {
namespace {

struct Rendered {
  SimulationReport report;
  double given_j = 0.0;
};

// A light tool in a soft hand, which a late force throws far. Answers are late from the
// 1500th on, when the hand is in contact.
Rendered rendered(const InverseFaults& faults) {
  const auto service = std::make_shared<std::shared_ptr<EmulatedInverse>>();
  DeviceRequest request{.name = "emulated-inverse"};
  request.driver_program =
      (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "palpate-run")
          .string();
  EmulatedInverseConfig like;
  like.dynamics.mass_kg = 0.08;
  like.dynamics.coulomb_n = 0.0;
  like.dynamics.hand_n_per_m = 30.0;
  like.dynamics.hand_n_s_per_m = 0.0;
  like.faults = faults;
  SimulationOptions options;
  options.duration_s = 3.0;
  options.fast_hz = 1000.0;
  options.real_time = true;
  options.attached = attach_emulated_inverse(request, like, service.get());
  const std::atomic<bool> stop = false;
  Rendered result{simulate(cylinder_body({.stiffness_n_per_m = 110.0, .friction = 0.0}),
                           options, stop)};
  result.given_j = (*service)->given_to_hand_j();
  return result;
}

// What is below the floor of 10 mJ disturbs no hand, and the run goes on.
TEST(LateService, GivesTheHandLittleOrEndsWithItsName) {
  for (const std::int64_t late_ms : {8, 18}) {
    const Rendered run = rendered(
        {.fault = InverseFault::kLate, .from = 1500, .late_ns = late_ms * 1'000'000});
    EXPECT_LE(run.given_j, 0.02) << late_ms << " ms";
    if (late_ms == 18) {  // more than four times too late for the body
      EXPECT_EQ(run.report.render.fault, Fault::kSlowWire)
          << name(run.report.render.fault);
    }
    EXPECT_GT(run.report.render.contact_ticks, 0) << late_ms << " ms";
  }
}

TEST(LateService, OneAnswerOfFiftyEndsNothing) {
  const Rendered run = rendered(
      {.fault = InverseFault::kLate, .from = 1500, .every = 50, .late_ns = 18'000'000});
  EXPECT_EQ(run.report.render.fault, Fault::kNone) << name(run.report.render.fault);
  EXPECT_LE(run.given_j, 0.02);
}

}  // namespace
}  // namespace palpate
