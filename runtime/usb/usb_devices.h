// Which haptic devices are on the USB bus, and whether they may be used.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace palpate {

enum class UsbAccess : std::uint8_t {
  kOk,          ///< can be opened
  kPermission,  ///< there, but this user may not open it
  kBusy,        ///< open elsewhere
  kFailed,      ///< any other reason
};

/// A device on the bus that palpate knows, or may know.
struct UsbDevice {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  int bus = 0;
  int address = 0;
  bool serial = false;  ///< offers a serial port (CDC-ACM)
  UsbAccess access = UsbAccess::kFailed;
  std::string failure{};        ///< why it cannot be opened; empty if it can
  std::string path{};           ///< ports from the root, "1-4.1"; empty if not known
  std::string serial_number{};  ///< empty if it has none or cannot be opened
};

struct UsbReport {
  std::string failure;             ///< why the bus cannot be read; empty if it can
  int seen = 0;                    ///< devices on the bus, of any kind
  std::vector<UsbDevice> devices;  ///< haptic devices and serial boards
};

/// Name of a haptic device by its numbers; empty if palpate does not know it.
[[nodiscard]] std::string haptic_device_name(std::uint16_t vendor,
                                             std::uint16_t product);

/// Looks at every device on the bus, opens those of interest for a moment. Never throws
/// for what is or is not attached.
[[nodiscard]] UsbReport find_usb_devices();

/// Rules for udev that let whoever sits at the machine use the known devices.
[[nodiscard]] std::string udev_rules();

/// The report for people: a line per device, with what to do where it cannot be used.
[[nodiscard]] std::string describe(const UsbReport& report);

}  // namespace palpate
