#include "runtime/usb/usb_devices.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

UsbReport with(const UsbDevice& device) {
  return {.failure = "", .seen = 3, .devices = {device}};
}

TEST(UsbDevices, SaysThatNothingIsAttached) {
  EXPECT_EQ(describe({.failure = "", .seen = 0, .devices = {}}),
            "no known haptic device is attached (0 USB devices seen)\n");
}

TEST(UsbDevices, NamesTheFalconByItsNumbers) {
  EXPECT_EQ(haptic_device_name(0x0403, 0xCB48), "Novint Falcon");
  EXPECT_EQ(haptic_device_name(0x0403, 0x6001), "");  // FTDI's own product
  UsbDevice falcon{.vendor = 0x0403, .product = 0xCB48, .bus = 1, .address = 9};
  falcon.access = UsbAccess::kOk;
  EXPECT_EQ(describe(with(falcon)),
            "0403:cb48 bus 1 address 9: Novint Falcon: ready\n");
}

TEST(UsbDevices, SaysHowToGetThePermission) {
  UsbDevice falcon{.vendor = 0x0403, .product = 0xCB48};
  falcon.access = UsbAccess::kPermission;
  EXPECT_NE(describe(with(falcon)).find("ATTR{idProduct}==\"cb48\", TAG+=\"uaccess\""),
            std::string::npos);
}

TEST(UsbDevices, DoesNotTakeASerialBoardForAKnownDevice) {
  UsbDevice board{.vendor = 0x2341, .product = 0x003E, .serial = true};
  board.access = UsbAccess::kBusy;
  const std::string text = describe(with(board));
  EXPECT_NE(text.find("may be a Haply"), std::string::npos);
  EXPECT_NE(text.find("in use by another program"), std::string::npos);
  EXPECT_NE(text.find("no known haptic device is attached (3 USB devices seen)"),
            std::string::npos);
}

TEST(UsbDevices, LooksAtTheBusOfThisMachineWithoutThrowing) {
  const UsbReport report = find_usb_devices();
  EXPECT_GE(report.seen, static_cast<int>(report.devices.size()));
  EXPECT_FALSE(describe(report).empty());
}

}  // namespace
}  // namespace palpate
