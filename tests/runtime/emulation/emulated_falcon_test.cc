// The driver of the Falcon against its model, libusb between them.
#include "runtime/emulation/emulated_falcon.h"

#include <fstream>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "runtime/realtime/clock.h"
#include "tests/support/held_falcon.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

// The tests of a run that ends well; true if it opened.
void open_and_push(const std::shared_ptr<EmulatedFalcon>& falcon,
                   const FalconConfig& config) {
  const auto link = EmulatedFalcon::link(falcon, config);
  link->open();
  EXPECT_FALSE(falcon->usb().kernel_driver());
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  int answered = 0;
  for (int i = 0; i < 20; ++i) {
    const LinkStatus status = link->transact({0.0, 0.0, 1.0}, position);
    ASSERT_NE(status, LinkStatus::kLost) << link->failure();
    answered += status == LinkStatus::kOk ? 1 : 0;
  }
  EXPECT_GE(answered, 10);
  EXPECT_NEAR(position.z(), 0.13, 0.02);
  EXPECT_NE(falcon->usb().locked([&] {
    return falcon->model().command().motor;
  }),
            (std::array<std::int16_t, 3>{}));
  link->close();
  EXPECT_EQ(falcon->model().command().motor, (std::array<std::int16_t, 3>{}));
  EXPECT_EQ(falcon->model().command().leds, 0);
  EXPECT_TRUE(falcon->kernel_driver_back());
  EXPECT_FALSE(falcon->model().driven_unhomed());
}

TEST(EmulatedFalcon, BootsLoadsHomesRendersAndIsLeftAsItWasFound) {
  EmulatedFalconConfig config = held_loaded_falcon();
  config.model.loaded = false;
  open_and_push(std::make_shared<EmulatedFalcon>(config), patient_driver());
}

TEST(EmulatedFalcon, NeedsNoFirmwareWhereOneRuns) {
  FalconConfig config = patient_driver();
  config.firmware.clear();
  open_and_push(std::make_shared<EmulatedFalcon>(held_loaded_falcon()), config);
}

TEST(EmulatedFalcon, LoadsAgainAfterAWrongEcho) {
  EmulatedFalconConfig config = held_loaded_falcon();
  config.model.loaded = false;
  config.model.echo_error_at = 70;
  config.model.echo_errors = 2;
  open_and_push(std::make_shared<EmulatedFalcon>(config), patient_driver());
}

TEST(EmulatedFalcon, LivesWithSplitGarbledAndStaleReplies) {
  EmulatedFalconConfig config = held_loaded_falcon();
  config.line = {.split_bytes = 7, .garbage = 0.002, .drop = 0.002};
  config.model.stale_every = 5;
  open_and_push(std::make_shared<EmulatedFalcon>(config), patient_driver());
}

TEST(EmulatedFalcon, LivesWithAStall) {
  EmulatedFalconConfig config = held_loaded_falcon();
  config.bus.stall_at_byte = 400;
  open_and_push(std::make_shared<EmulatedFalcon>(config), patient_driver());
}

std::string message_of_open(const EmulatedFalconConfig& emulated,
                            const FalconConfig& config) {
  const auto falcon = std::make_shared<EmulatedFalcon>(emulated);
  const auto link = EmulatedFalcon::link(falcon, config);
  try {
    link->open();
  } catch (const DeviceError& error) {
    EXPECT_TRUE(falcon->kernel_driver_back());
    EXPECT_FALSE(falcon->model().driven_unhomed());
    return error.what();
  }
  return "";
}

TEST(EmulatedFalcon, SaysWhatIsWrongWhenItCannotBeOpened) {
  EmulatedFalconConfig cold = held_loaded_falcon();
  cold.model.loaded = false;
  FalconConfig config = patient_driver();
  config.answer_s = 0.005;  // for the hundreds of answers that never come
  config.firmware.clear();
  EXPECT_NE(message_of_open(cold, config).find("--firmware"), std::string::npos);
  config.firmware.assign(100, 7);
  EXPECT_NE(message_of_open(cold, config).find("not loaded in 10 tries"),
            std::string::npos);
  EmulatedFalconConfig unhomed = held_loaded_falcon();
  unhomed.model.homing_ns = -1;
  config = patient_driver();
  config.homing_s = 0.05;
  EXPECT_NE(message_of_open(unhomed, config).find("not homed"), std::string::npos);
}

// Everything from the first control request to the loop, in both ways in which host
// controllers report it.
// At every step of a boot, and while it waits to be homed.
TEST(EmulatedFalcon, AWishToStopIsHeededWhileItOpens) {
  for (const int looks : {1, 30, 200, 800}) {
    EmulatedFalconConfig emulated = held_loaded_falcon();
    emulated.model.loaded = false;
    emulated.model.homing_ns = -1;  // nobody homes it
    const auto falcon = std::make_shared<EmulatedFalcon>(emulated);
    FalconConfig config = patient_driver();
    config.answer_s = 0.01;
    config.homing_s = 60.0;
    int count = 0;
    config.stopped = [&] {
      return ++count >= looks;
    };
    const auto link = EmulatedFalcon::link(falcon, config);
    EXPECT_THROW(link->open(), Interrupted) << looks;
    EXPECT_EQ(count, looks);  // it was the last that was asked
    EXPECT_TRUE(falcon->kernel_driver_back());
  }
}

TEST(EmulatedFalcon, SaysWhatItSendsWhereItsMotorsSaturate) {
  const auto falcon = std::make_shared<EmulatedFalcon>(held_loaded_falcon());
  FalconConfig config = patient_driver();
  config.force_max_n = 100.0;
  const auto link = EmulatedFalcon::link(falcon, config);
  link->open();
  Eigen::Vector3d position;
  for (int i = 0; i < 20; ++i) {
    ASSERT_NE(link->transact({0.0, 0.0, 1.0}, position), LinkStatus::kLost);
  }
  EXPECT_NEAR(link->sent_n().z(), 1.0, 0.01);  // whole counts
  ASSERT_NE(link->transact({0.0, 0.0, 90.0}, position), LinkStatus::kLost);
  EXPECT_GT(link->sent_n().z(), 2.0);
  EXPECT_LT(link->sent_n().z(), 60.0);
  link->close();
}

TEST(EmulatedFalcon, UnpluggedAtAnyByteIsALossWithAName) {
  std::mt19937 random(1);
  int in_loop = 0;
  for (int i = 0; i < 200; ++i) {
    EmulatedFalconConfig config = held_loaded_falcon();
    config.model.loaded = i % 8 >= 2;
    config.model.homing_ns = 0;
    config.bus.unplug_at_byte = 1 + static_cast<std::int64_t>(random() % 1500);
    config.bus.unplug_is_io_error = i % 2 == 1;
    const auto falcon = std::make_shared<EmulatedFalcon>(config);
    FalconConfig quick = patient_driver();
    quick.answer_s = 0.005;
    const auto link = EmulatedFalcon::link(falcon, quick);
    std::string why;
    try {
      link->open();
      Eigen::Vector3d position;
      for (int k = 0; k < 1000 && why.empty(); ++k) {
        if (link->transact({0.5, 0.0, 0.0}, position) == LinkStatus::kLost) {
          why = link->failure();
          ++in_loop;
        }
      }
    } catch (const DeviceError& error) {
      why = error.what();
    }
    EXPECT_FALSE(why.empty()) << config.bus.unplug_at_byte;
    link->close();
    EXPECT_FALSE(falcon->model().driven_unhomed());
  }
  EXPECT_GT(in_loop, 10);
  EXPECT_LT(in_loop, 190);
}

TEST(EmulatedFalcon, ADeviceThatStopsAnsweringIsNeverWaitedForLong) {
  EmulatedFalconConfig config = held_loaded_falcon();
  config.bus.silent_from_byte = 800;
  FalconConfig quick = patient_driver();
  quick.answer_s = 0.005;
  const auto link =
      EmulatedFalcon::link(std::make_shared<EmulatedFalcon>(config), quick);
  link->open();
  Eigen::Vector3d position;
  int missed = 0;
  for (int i = 0; i < 100; ++i) {
    missed += link->transact({0.5, 0.0, 0.0}, position) == LinkStatus::kMissed ? 1 : 0;
  }
  EXPECT_GT(missed, 50);
}

TEST(LinkedFalcon, TakesTheForceAwayWhenTheHostFallsSilent) {
  const auto falcon = std::make_shared<EmulatedFalcon>(held_loaded_falcon());
  LinkedDevice device(EmulatedFalcon::link(falcon, patient_driver()), {});
  device.open();
  const auto driven = [&] {
    return falcon->usb().locked([&] {
      return falcon->model().command().motor != std::array<std::int16_t, 3>{};
    });
  };
  const auto wait_for = [&](bool wanted, const Eigen::Vector3d* force) {
    for (int i = 0; i < 2000 && driven() != wanted; ++i) {
      if (force != nullptr) {
        EXPECT_EQ(device.write(*force), DeviceStatus::kOk);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return driven() == wanted;
  };
  const Eigen::Vector3d push(0.0, 0.0, 1.0);
  EXPECT_TRUE(wait_for(true, &push));
  EXPECT_TRUE(wait_for(false, nullptr));
  device.close();
  EXPECT_GE(device.wire()->silences, 1);
  EXPECT_TRUE(falcon->kernel_driver_back());
}

TEST(LinkedFalcon, OpensAgainAfterItWasClosed) {
  const auto falcon = std::make_shared<EmulatedFalcon>(held_loaded_falcon());
  LinkedDevice device(EmulatedFalcon::link(falcon, patient_driver()), {});
  for (int i = 0; i < 3; ++i) {
    device.open();
    DeviceReading reading;
    EXPECT_NE(device.read(reading), DeviceStatus::kLost);
    device.close();
  }
}

TEST(Firmware, OfAFileThatCannotBeOneIsRefused) {
  EXPECT_THROW((void)read_firmware("/nonexistent"), InputError);
  EXPECT_THROW((void)read_firmware("/dev/null"), InputError);
  const ScratchFolder folder;
  const auto file = [&](std::size_t bytes) {
    std::ofstream(folder / "image.bin", std::ios::binary) << std::string(bytes, 'x');
    return (folder / "image.bin").string();
  };
  EXPECT_EQ(read_firmware(file(1000)), std::vector<std::uint8_t>(1000, 'x'));
  EXPECT_EQ(read_firmware(file(kFirmwareBytesMax)).size(), kFirmwareBytesMax);
  EXPECT_THROW((void)read_firmware(file(0)), InputError);
  EXPECT_THROW((void)read_firmware(file(kFirmwareBytesMax + 1)), InputError);
}

}  // namespace
}  // namespace palpate
