// Which device on the USB bus a person means.
#pragma once

#include <string>

#include "runtime/usb/usb_devices.h"

namespace palpate {

/// "bus 1 address 9, port 1-2.3, serial number FT12".
[[nodiscard]] std::string place_of(const UsbDevice& device);

/// The one device for which `is_meant` holds and that lies at `where`. `where` is
/// "BUS:ADDRESS", a port ("1-2.3", which stays when the device is plugged in again) or
/// a serial number; empty: anywhere. @param what the device's name, for messages.
/// @throws DeviceError if there is none, if there are several (naming all), or if it
/// must not be opened (naming the rule that permits it).
[[nodiscard]] UsbDevice choose_usb_device(const UsbReport& report,
                                          const std::string& what,
                                          const std::string& where,
                                          bool (*is_meant)(const UsbDevice&));

}  // namespace palpate
