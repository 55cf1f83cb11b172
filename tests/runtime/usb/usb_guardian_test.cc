// What a guardian sends to a device whose renderer was killed: it has the descriptor
// and nothing else.
#include "runtime/usb/usb_guardian.h"

#include <gtest/gtest.h>

#include "runtime/emulation/emulated_falcon.h"
#include "runtime/emulation/emulated_haply.h"

namespace palpate {
namespace {

TEST(UsbGuardian, TakesForceAndLightFromAFalconThatWasLeftDriven) {
  EmulatedFalconConfig config;
  config.model.loaded = true;
  config.model.homing_ns = 0;
  const auto falcon = std::make_shared<EmulatedFalcon>(config);
  FalconConfig driver;
  driver.answer_s = 0.05;  // a test machine may pause
  const auto link = EmulatedFalcon::link(falcon, driver);
  link->open();
  const auto motors = [&] {
    return falcon->usb().locked([&] {
      return falcon->model().command().motor;
    });
  };
  Eigen::Vector3d position;
  for (int i = 0; i < 100 && motors() == std::array<std::int16_t, 3>{}; ++i) {
    static_cast<void>(link->transact({0.0, 0.0, 1.0}, position));
  }
  EXPECT_NE(motors(), (std::array<std::int16_t, 3>{}));
  zero_falcon(falcon->usb().descriptor(), false);
  EXPECT_EQ(motors(), (std::array<std::int16_t, 3>{}));
  EXPECT_FALSE(falcon->usb().kernel_driver());
  zero_falcon(falcon->usb().descriptor(), true);
  EXPECT_EQ(falcon->model().command().leds, 0);
  EXPECT_TRUE(falcon->usb().kernel_driver());
}

TEST(UsbGuardian, TakesTheTorqueFromABoardThatKeepsItForEver) {
  HaplyModelConfig config;
  config.hand.surface_m = config.start_m;
  const auto haply = std::make_shared<EmulatedHaply>(config, UsbFaults{});
  HaplyConfig driver;
  driver.answer_s = 0.05;
  const auto link = EmulatedHaply::link(haply, driver);
  link->open();
  const auto torque = [&] {
    return haply->usb().locked([&] {
      return haply->model().torque_nm();
    });
  };
  Eigen::Vector3d position;
  for (int i = 0; i < 100 && torque() == std::array<double, 2>{}; ++i) {
    static_cast<void>(link->transact({0.0, 0.5, 0.0}, position));
  }
  EXPECT_NE(torque(), (std::array<double, 2>{}));
  zero_haply(haply->usb().descriptor(), true);
  EXPECT_EQ(torque(), (std::array<double, 2>{}));
  EXPECT_TRUE(haply->usb().kernel_driver());
}

}  // namespace
}  // namespace palpate
