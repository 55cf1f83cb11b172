#include "runtime/attach/usb_choice.h"

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

bool is_falcon(const UsbDevice& device) {
  return !haptic_device_name(device.vendor, device.product).empty();
}

UsbDevice falcon(int address, const std::string& path, const std::string& serial) {
  UsbDevice device{.vendor = 0x0403, .product = 0xCB48, .bus = 1, .address = address};
  device.access = UsbAccess::kOk;
  device.path = path;
  device.serial_number = serial;
  return device;
}

UsbReport two_falcons_and_a_board() {
  const UsbDevice board{.vendor = 0x2341, .product = 0x003E, .bus = 1, .serial = true};
  return {.failure = "",
          .seen = 5,
          .devices = {falcon(7, "1-2", "FA1"), board, falcon(9, "1-4.1", "FA2")}};
}

std::string message(const UsbReport& report, const std::string& where) {
  try {
    static_cast<void>(choose_usb_device(report, "falcon", where, is_falcon));
  } catch (const DeviceError& error) {
    return error.what();
  }
  return "";
}

TEST(UsbChoice, OfTwoAlikeIsByAddressPortOrSerialNumber) {
  const UsbReport report = two_falcons_and_a_board();
  for (const char* where : {"1:9", "1-4.1", "FA2"}) {
    EXPECT_EQ(choose_usb_device(report, "falcon", where, is_falcon).address, 9);
  }
  EXPECT_EQ(choose_usb_device(report, "falcon", "FA1", is_falcon).address, 7);
}

TEST(UsbChoice, OfTwoAlikeWithoutAPlaceIsRefusedNamingBoth) {
  EXPECT_EQ(message(two_falcons_and_a_board(), ""),
            "falcon: 2 are attached; choose one by --usb: 1:7, port 1-2, serial number "
            "FA1; 1:9, port 1-4.1, serial number FA2");
}

TEST(UsbChoice, OfAPlaceWithoutADeviceSaysWhereTheyAre) {
  const std::string text = message(two_falcons_and_a_board(), "2:3");
  EXPECT_NE(text.find("none is attached at 2:3 (5 USB devices seen; elsewhere: 1:7"),
            std::string::npos)
      << text;
  EXPECT_NE(message({.failure = "no bus", .seen = 0, .devices = {}}, "").find("no bus"),
            std::string::npos);
}

TEST(UsbChoice, OfADeviceThatMayNotBeOpenedNamesTheRemedy) {
  UsbReport report = two_falcons_and_a_board();
  report.devices[0].access = UsbAccess::kPermission;
  report.devices[2].access = UsbAccess::kBusy;
  EXPECT_NE(message(report, "FA1")
                .find("no permission to open it (1:7, port 1-2, serial "
                      "number FA1); palpate-run devices --udev"),
            std::string::npos);
  EXPECT_NE(message(report, "FA2").find("in use by another program"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate
