// From a device's name to a driver for it.
#pragma once

#include <functional>
#include <string>

#include "runtime/attached_device.h"

namespace palpate {

struct DeviceRequest {
  std::string name;          ///< one of known_device_names()
  std::string firmware;      ///< file; empty: none
  std::string usb;           ///< BUS:ADDRESS; empty: the only one
  double calibration = 1.0;  ///< [-] (0, 10] factor on motor commands
  double homing_s = 60.0;    ///< [s] > 0
  std::function<void(const std::string&)> tell;  ///< what the person is to do
};

/// With commas between them.
[[nodiscard]] std::string known_device_names();

/// @throws InputError for an unknown name or a firmware file that cannot be one;
/// DeviceError where hardware is missing, ambiguous or not permitted.
[[nodiscard]] AttachedDevice choose_device(const DeviceRequest& request);

}  // namespace palpate
