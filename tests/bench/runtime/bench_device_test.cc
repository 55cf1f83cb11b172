// The closed loop of renderer, driver, libusb, emulated chip and mechanism.
#include "tests/bench/runtime/bench_device.h"

#include <filesystem>
#include <limits>

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

// Where the wire is slower than usual, forces get older, and the bound with them.
TEST(DeviceBench, MotorsGiveNoMoreThanTheAgeOfForcesExplains) {
  for (const bool event_character : {false, true}) {
    const DeviceBenchReport report =
        run_device_bench({.duration_s = 2.0, .event_character = event_character});
    EXPECT_GT(report.contact_ticks, 100);
    EXPECT_GT(report.force_max_n, 0.1);
    EXPECT_GE(report.model_work_j, 0.0);
    EXPECT_GE(report.energy.margin_min_j, 0.0);
    EXPECT_GT(report.energy.bound_end_j, 0.0);
    EXPECT_GT(report.wire.force_age.count(), 0U);
  }
}

// Through driver process, socket and WebSocket; and the buses of the other two.
TEST(DeviceBench, HoldsForTheOtherEmulationsToo) {
  const auto bin = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  for (const char* device :
       {"emulated-haply", "emulated-inverse", "emulated-inverse3"}) {
    const DeviceBenchReport report =
        run_device_bench({.device = device,
                          .duration_s = 2.0,
                          .driver_program = (bin / "palpate-run").string()});
    EXPECT_GT(report.contact_ticks, 100) << device;
    EXPECT_GE(report.energy.margin_min_j, 0.0) << device;
    EXPECT_GT(report.energy.bound_end_j, 0.0) << device;
    EXPECT_GT(report.wire.transactions, 1000) << device;
    EXPECT_GT(report.wire.force_age.count(), 100U) << device;
  }
}

TEST(DeviceBench, FrictionTakesEnergyOutOfTheLoop) {
  const DeviceBenchReport report =
      run_device_bench({.duration_s = 2.0, .friction = 0.5});
  EXPECT_LT(report.energy.given_end_j, 0.0);
}

TEST(DeviceBench, OptionsOutOfRangeAreRefused) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double wrong : {0.0, -1.0, 1e9, kNan}) {
    EXPECT_THROW((void)run_device_bench({.duration_s = wrong}), InputError);
  }
  EXPECT_THROW((void)run_device_bench({.stiffness_n_per_m = kNan}), InputError);
  EXPECT_THROW((void)run_device_bench({.friction = -0.1}), InputError);
  EXPECT_THROW((void)run_device_bench({.device = "falcon"}), InputError);
}

}  // namespace
}  // namespace palpate
