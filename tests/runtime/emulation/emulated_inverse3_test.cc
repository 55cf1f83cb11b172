// The driver of an Inverse3's own board against its model, libusb between them.
#include "runtime/emulation/emulated_inverse3.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

const Eigen::Vector3d kPush(0.5, 0.25, -1.0);

// Nobody holds the tool.
Inverse3ModelConfig model_config() {
  Inverse3ModelConfig config;
  config.dynamics.hand_n_per_m = 0.0;
  config.dynamics.hand_n_s_per_m = 5.0;
  return config;
}

Inverse3Config inverse3_driver() {
  Inverse3Config config;
  config.answer_s = 0.05;  // a test machine may pause
  config.wake_s = 0.01;
  return config;
}

Eigen::Vector3d force_n(const EmulatedInverse3& device) {
  return device.usb().locked([&] {
    return device.model().force_n();
  });
}

TEST(EmulatedInverse3, WakesUpRendersAndIsLeftWithoutForce) {
  for (const bool newer : {false, true}) {
    Inverse3ModelConfig config = model_config();
    config.newer = newer;
    config.split_bytes = newer ? 7 : 64;
    const auto device = std::make_shared<EmulatedInverse3>(config, UsbFaults{});
    const auto link = EmulatedInverse3::link(device, inverse3_driver());
    link->open();
    Eigen::Vector3d position_m;
    ASSERT_EQ(link->transact(kPush, position_m), LinkStatus::kOk);
    EXPECT_NEAR((position_m - config.start_m).norm(), 0.0, 1e-3);
    for (int i = 0; i < 100; ++i) {
      ASSERT_EQ(link->transact(kPush, position_m), LinkStatus::kOk);
    }
    EXPECT_EQ(force_n(*device), kPush);
    EXPECT_GT((position_m - config.start_m).dot(kPush), 0.0);
    ASSERT_EQ(link->transact(100.0 * kPush, position_m), LinkStatus::kOk);
    EXPECT_NEAR(force_n(*device).norm(), 5.0, 1e-6);
    link->close();
    EXPECT_EQ(device->model().force_n(), Eigen::Vector3d::Zero());
    EXPECT_TRUE(device->kernel_driver_back());
  }
}

TEST(EmulatedInverse3, NonsenseTakesTheForceAwayAndIsGotOver) {
  Inverse3ModelConfig config = model_config();
  config.garbage_at = 20;
  const auto device = std::make_shared<EmulatedInverse3>(config, UsbFaults{});
  const auto link = EmulatedInverse3::link(device, inverse3_driver());
  link->open();
  Eigen::Vector3d position_m;
  int missed = 0;
  for (int i = 0; i < 60; ++i) {
    const LinkStatus status = link->transact(kPush, position_m);
    ASSERT_NE(status, LinkStatus::kLost);
    if (status == LinkStatus::kMissed) {
      ++missed;
      ASSERT_EQ(link->transact(kPush, position_m), LinkStatus::kOk);
      EXPECT_EQ(force_n(*device), Eigen::Vector3d::Zero());  // the next message
    }
  }
  EXPECT_EQ(missed, 1);
  EXPECT_EQ(force_n(*device), kPush);
}

// Before the line is listened to, and once more as it is asked again.
TEST(EmulatedInverse3, AfterNonsenseZeroGoesFirst) {
  Inverse3ModelConfig config = model_config();
  config.garbage_at = 20;
  config.trace_max = 100;
  const auto device = std::make_shared<EmulatedInverse3>(config, UsbFaults{});
  const auto link = EmulatedInverse3::link(device, inverse3_driver());
  link->open();
  Eigen::Vector3d position_m;
  for (int i = 0; i < 30; ++i) {
    ASSERT_NE(link->transact(kPush, position_m), LinkStatus::kLost);
  }
  link->close();
  const std::vector<MotorRecord>& trace = device->model().trace();
  ASSERT_GT(trace.size(), 25U);
  const auto pushed = std::find_if(trace.begin(), trace.end(), [](const auto& command) {
    return command.force_n > 0.0;
  });
  const auto zero = std::find_if(pushed, trace.end(), [](const auto& command) {
    return command.force_n == 0.0;
  });
  const auto again = std::find_if(zero, trace.end(), [](const auto& command) {
    return command.force_n > 0.0;
  });
  EXPECT_EQ(again - zero, 2);
}

TEST(EmulatedInverse3, NonsenseForGoodIsALossWithZeroForce) {
  Inverse3ModelConfig config = model_config();
  config.garbage_at = 20;
  config.garbage_count = 100'000;
  const auto device = std::make_shared<EmulatedInverse3>(config, UsbFaults{});
  const auto link = EmulatedInverse3::link(device, inverse3_driver());
  link->open();
  Eigen::Vector3d position_m;
  LinkStatus status = LinkStatus::kOk;
  for (int i = 0; i < 1000 && status != LinkStatus::kLost; ++i) {
    status = link->transact(kPush, position_m);
  }
  EXPECT_EQ(status, LinkStatus::kLost);
  EXPECT_EQ(link->failure(), "its answers are none, or its tool jumps");
  EXPECT_EQ(force_n(*device), Eigen::Vector3d::Zero());
}

TEST(EmulatedInverse3, ThatIsDeafOrSilentHasAName) {
  Inverse3ModelConfig config = model_config();
  config.deaf = 1000;
  const auto deaf = std::make_shared<EmulatedInverse3>(config, UsbFaults{});
  try {
    EmulatedInverse3::link(deaf, inverse3_driver())->open();
    FAIL() << "opened";
  } catch (const DeviceError& error) {
    EXPECT_NE(std::string(error.what()).find("does not wake up"), std::string::npos);
  }
  const auto silent = std::make_shared<EmulatedInverse3>(
      model_config(), UsbFaults{.silent_from_byte = 2000});
  Inverse3Config quick = inverse3_driver();
  quick.answer_s = 0.005;
  const auto link = EmulatedInverse3::link(silent, quick);
  link->open();
  Eigen::Vector3d position_m;
  LinkStatus status = LinkStatus::kOk;
  for (int i = 0; i < 500 && status != LinkStatus::kLost; ++i) {
    status = link->transact(kPush, position_m);
  }
  EXPECT_EQ(status, LinkStatus::kLost);
  EXPECT_EQ(link->failure(), "answers no more");
}

TEST(EmulatedInverse3, UnpluggedAtAnyByteIsALossWithAName) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> byte(1, 2000);
  Inverse3ModelConfig config = model_config();
  config.deaf = 0;
  for (int i = 0; i < 200; ++i) {
    const auto device = std::make_shared<EmulatedInverse3>(
        config,
        UsbFaults{.unplug_at_byte = byte(random), .unplug_is_io_error = i % 2 == 0});
    const auto link = EmulatedInverse3::link(device, inverse3_driver());
    std::string why;
    try {
      link->open();
      Eigen::Vector3d position_m;
      for (int k = 0; k < 200 && why.empty(); ++k) {
        if (link->transact(kPush, position_m) == LinkStatus::kLost) {
          why = link->failure();
        }
      }
    } catch (const DeviceError& error) {
      why = error.what();
    }
    EXPECT_NE(why, "");
  }
}

}  // namespace
}  // namespace palpate
