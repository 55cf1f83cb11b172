#include "runtime/run/reconnect.h"

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/recording/recording.h"
#include "runtime/bench/cylinder_body.h"
#include "runtime/emulation/emulated_falcon.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

// A Falcon that is unplugged in its loop, is away for some openings, then is well.
struct Unplugged {
  int away = 2;  ///< openings that fail
  int opened = 0;
  std::vector<std::shared_ptr<EmulatedFalcon>> falcons{};

  AttachedDevice device() {
    FalconConfig driver;
    driver.answer_s = 0.05;  // a test machine may pause
    return attach(
        FalconLink(driver, nullptr, nullptr).limits(), falcon_centre_m(),
        [this, driver](const HandScript& hand) -> std::unique_ptr<DeviceLink> {
          ++opened;
          if (opened > 1 && opened <= 1 + away) {
            throw DeviceError("falcon: none is attached");
          }
          EmulatedFalconConfig config;
          config.model.loaded = true;
          config.model.hand = hand;
          config.model.start_m = hand.at(0.0).position_m;
          config.bus.unplug_at_byte = opened == 1 ? 12'000 : -1;
          falcons.push_back(std::make_shared<EmulatedFalcon>(config));
          return EmulatedFalcon::link(falcons.back(), driver);
        });
  }
};

SimulationOptions real_time_run(AttachedDevice device) {
  SimulationOptions run;
  run.duration_s = 1.5;
  run.fast_hz = 1000.0;
  run.real_time = true;
  run.attached = std::move(device);
  return run;
}

TEST(Reconnect, RendersTheRestOfTheTimeOnceTheDeviceIsBack) {
  Unplugged falcon;
  std::string told;
  const std::atomic<bool> stop = false;
  const ScratchFolder folder;
  SimulationOptions wanted = real_time_run(falcon.device());
  wanted.recording.file = folder / "run.h5";
  const auto runs = simulate_and_reconnect(cylinder_body({.friction = 0.0}), wanted,
                                           {.patience_s = 30.0,
                                            .look_s = 0.01,
                                            .tell =
                                                [&told](const std::string& text) {
                                                  told += text;
                                                }},
                                           stop);
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[0].render.fault, Fault::kDeviceLost);
  EXPECT_EQ(runs[1].render.fault, Fault::kNone);
  EXPECT_EQ(falcon.opened, 4);
  EXPECT_EQ(
      told,
      "falcon: lost (unplugged, or its wire is broken); no force until it is back");
  EXPECT_NEAR(runs[0].render.duration_s + runs[1].options.duration_s, 1.5, 1e-9);
  // Each run has its recording.
  const Recording lost = read_recording(folder / "run.h5");
  EXPECT_EQ(std::ssize(lost.tick), runs[0].render.ticks);
  EXPECT_EQ(lost.end.fault, "device-lost");
  EXPECT_EQ(std::ssize(read_recording(folder / "run.2.h5").tick), runs[1].render.ticks);
  EXPECT_EQ(falcon.falcons.back()->model().command().motor,
            (std::array<std::int16_t, 3>{}));
}

TEST(Reconnect, GivesUpADeviceThatDoesNotComeBack) {
  Unplugged falcon{.away = 1'000'000};
  const std::atomic<bool> stop = false;
  EXPECT_THROW((void)simulate_and_reconnect(
                   cylinder_body({.friction = 0.0}), real_time_run(falcon.device()),
                   {.patience_s = 0.05, .look_s = 0.01, .tell = {}}, stop),
               DeviceError);
  EXPECT_GE(falcon.opened, 3);
}

TEST(Reconnect, DoesNotWaitForADeviceThatWasNeverThere) {
  SimulationOptions run = real_time_run({});
  run.attached->limits = {.damping_n_s_per_m = 10.0, .force_max_n = 8.0};
  run.attached->make = [](const HandScript&) -> std::unique_ptr<Device> {
    throw DeviceError("falcon: none is attached");
  };
  const std::atomic<bool> stop = false;
  EXPECT_THROW((void)simulate_and_reconnect(
                   cylinder_body({.friction = 0.0}), run,
                   {.patience_s = 30.0, .look_s = 0.01, .tell = {}}, stop),
               DeviceError);
}

}  // namespace
}  // namespace palpate
