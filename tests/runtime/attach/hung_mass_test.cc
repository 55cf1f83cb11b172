// Calibration of an emulated Falcon by a hung mass; and its file.
#include "runtime/attach/hung_mass.h"

#include <array>
#include <atomic>
#include <chrono>
#include <fstream>
#include <future>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "runtime/attach/calibration.h"
#include "tests/support/held_falcon.h"
#include "tests/support/test_data.h"
#include "tests/support/undisturbed.h"

namespace palpate {
namespace {

constexpr double kHungMassKg = 0.15;
constexpr std::array kGains{0.8, 1.25};
constexpr WeighOptions kQuick{.period_s = 0.5, .periods = 3, .settle_s = 2.4};

// A weak spring from far below pulls like a weight.
std::shared_ptr<EmulatedFalcon> falcon_that_carries(double hung_n, double motor_gain) {
  constexpr double kPull = 0.1;  // [N/m]
  EmulatedFalconConfig config;
  config.model.loaded = true;
  config.model.motor_gain = motor_gain;
  config.model.dynamics.hand_n_per_m = kPull;
  config.model.dynamics.hand_n_s_per_m = 30.0;  // it sinks slowly until it is carried
  config.model.dynamics.resolution_m = 0.0;
  config.model.hand = {.surface_m = {0.0, -hung_n / kPull, 0.12},
                       .clear_m = 1e-9,
                       .press_m = 0.0,
                       .deeper_m = 0.0,
                       .circle_m = 0.0};
  return std::make_shared<EmulatedFalcon>(config);
}

Weight weighed(const std::shared_ptr<EmulatedFalcon>& falcon,
               const std::atomic<bool>& stop) {
  const auto link = EmulatedFalcon::link(falcon, patient_driver());
  link->open();
  return weigh(*link, falcon_centre_m(), kQuick, stop);
}

// 2 %: half the tool's dry friction of 0.03 N against 1.5 N, and the pauses of a
// machine.
TEST(Weigh, FindsTheFactorThatUndoesTheMotorsGainAndNotTheMechanismsWeight) {
  // All at once: each waits for its sweeps most of the time.
  const auto weighing = [](double hung_n, double gain) {
    return std::async(std::launch::async, [=] {
      return weighed(falcon_that_carries(hung_n, gain), false);
    });
  };
  struct Pair {
    double gain;
    Weight bare, loaded;
  };
  std::vector<Pair> pairs;
  undisturbed([&] {
    pairs.clear();
    std::vector<std::future<Weight>> bare, loaded;
    for (const double gain : kGains) {
      bare.push_back(weighing(0.3, gain));
      loaded.push_back(weighing(0.3 + kHungMassKg * 9.80665, gain));
    }
    for (std::size_t i = 0; i < kGains.size(); ++i) {
      pairs.push_back({kGains[i], bare[i].get(), loaded[i].get()});
    }
  });
  for (const Pair& pair : pairs) {
    double sd = 0.0;
    const double factor = factor_of(pair.bare, pair.loaded, kHungMassKg, sd);
    EXPECT_NEAR(factor * pair.gain, 1.0, 0.02);
    EXPECT_LT(sd, 0.05);
  }
}

TEST(Weigh, StoppedItLeavesNoForce) {
  const auto falcon = falcon_that_carries(1.0, 1.0);
  auto link = EmulatedFalcon::link(falcon, patient_driver());
  link->open();
  const auto has_force = [&] {
    return falcon->model().command().motor != std::array<std::int16_t, 3>{};
  };
  std::atomic<bool> stop = false;
  std::atomic<bool> had_force = false;
  std::jthread person([&] {
    for (int i = 0; i < 10'000 && !had_force; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      had_force = falcon->usb().locked(has_force);
    }
    stop = true;
  });
  EXPECT_THROW((void)weigh(*link, falcon_centre_m(), kQuick, stop), Interrupted);
  person.join();
  EXPECT_TRUE(had_force);
  EXPECT_TRUE(falcon->usb().locked(has_force));
  link.reset();
  EXPECT_FALSE(has_force());
}

TEST(Weigh, AFactorThatNoDeviceHasIsRefused) {
  double sd = 0.0;
  EXPECT_THROW((void)factor_of({.force_n = 1.0}, {.force_n = 1.0}, 0.1, sd),
               DeviceError);
  EXPECT_THROW((void)factor_of({.force_n = 0.0}, {.force_n = 9.0}, 0.1, sd),
               DeviceError);
}

class CalibrationFile : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path with(const std::string& text) const {
    std::ofstream(folder_ / "c.toml") << text;
    return folder_ / "c.toml";
  }
  ScratchFolder folder_;
};

TEST_F(CalibrationFile, ReadsWhatWasWritten) {
  write_calibration(folder_ / "c.toml", {.device = "falcon",
                                         .motor_factor = 1.0 / 3.0,
                                         .motor_factor_sd = 0.01,
                                         .mass_kg = 0.2});
  const Calibration read = read_calibration(folder_ / "c.toml");
  EXPECT_EQ(read.device, "falcon");
  EXPECT_EQ(read.motor_factor, 1.0 / 3.0);
  EXPECT_EQ(read.motor_factor_sd, 0.01);
  EXPECT_EQ(read.mass_kg, 0.2);
  EXPECT_EQ(motor_factor((folder_ / "c.toml").string(), "falcon"), 1.0 / 3.0);
  EXPECT_THROW((void)motor_factor((folder_ / "c.toml").string(), "haply-2diy"),
               InputError);
  EXPECT_EQ(motor_factor("1.5", "falcon"), 1.5);
}

TEST_F(CalibrationFile, ThatIsNoneIsRefused) {
  EXPECT_THROW((void)read_calibration("/nonexistent"), InputError);
  EXPECT_THROW((void)read_calibration(with("")), FormatError);
  EXPECT_THROW((void)read_calibration(with("format = 1")), FormatError);
  EXPECT_THROW((void)read_calibration(with("format = ")), FormatError);
  const std::string head = "format = \"palpate calibration\"\ndevice = \"falcon\"\n";
  EXPECT_THROW((void)read_calibration(with(head + "version = 2\nmotor_factor = 1.0\n")),
               FormatError);
  for (const char* wrong : {"0.0", "-1.0", "nan", "inf", "10.5", "\"1\""}) {
    EXPECT_THROW((void)read_calibration(
                     with(head + "version = 1\nmotor_factor = " + wrong + "\n")),
                 FormatError)
        << wrong;
  }
}

}  // namespace
}  // namespace palpate
