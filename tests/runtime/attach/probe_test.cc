// What a probe finds of emulated devices is what they were made with.
#include "runtime/attach/probe.h"

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "runtime/emulation/emulated_inverse3.h"

namespace palpate {
namespace {

// Nobody holds it.
Inverse3ModelConfig let_go() {
  Inverse3ModelConfig config;
  config.deaf = 0;
  config.dynamics.hand_n_per_m = 0.0;
  config.dynamics.hand_n_s_per_m = 0.0;
  return config;
}

ProbeReport probed(const Inverse3ModelConfig& model, const ProbeOptions& options) {
  Inverse3Config config;
  config.answer_s = 0.05;  // a test machine may pause
  const auto device = std::make_shared<EmulatedInverse3>(model, UsbFaults{});
  const auto link = EmulatedInverse3::link(device, config);
  link->open();
  return probe(*link, options, {});
}

// The delay is counted in exchanges there, a millisecond each.
TEST(Probe, FindsMassFrictionStepAndDelayOfAnEmulatedDevice) {
  struct Made {
    double mass_kg, coulomb_n, resolution_m;
    int delay_ticks;
  };
  for (const Made& made : {Made{0.12, 0.03, 5e-5, 4}, Made{0.2, 0.06, 2e-5, 8}}) {
    Inverse3ModelConfig model = let_go();
    model.dynamics.mass_kg = made.mass_kg;
    model.dynamics.coulomb_n = made.coulomb_n;
    model.dynamics.resolution_m = made.resolution_m;
    model.dynamics.delay_ticks = made.delay_ticks;
    const ProbeReport found =
        probed(model, {.rise_n_per_s = 0.15, .wire_s = 0.1, .rounds = 1, .pushes = 10});
    EXPECT_NEAR(found.mass_kg, made.mass_kg, 0.1 * made.mass_kg) << probe_text(found);
    EXPECT_NEAR(found.friction_n, made.coulomb_n, 0.1 * made.coulomb_n)
        << probe_text(found);
    EXPECT_NEAR(found.resolution_m, made.resolution_m, 0.1 * made.resolution_m);
    EXPECT_NEAR(found.delay_s, 1e-3 * made.delay_ticks, 1e-4 * made.delay_ticks)
        << probe_text(found);
    EXPECT_GT(found.free_rate_hz, 100.0);
  }
}

TEST(Probe, SaysWhatItCannotMove) {
  Inverse3ModelConfig model = let_go();
  model.dynamics.coulomb_n = 0.5;
  try {
    static_cast<void>(probed(model, {.rise_n_per_s = 3.0, .wire_s = 0.1}));
    FAIL() << "found something";
  } catch (const DeviceError& error) {
    EXPECT_NE(std::string(error.what()).find("moved nothing"), std::string::npos);
  }
}

}  // namespace
}  // namespace palpate
