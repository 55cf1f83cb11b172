// From a device's name to a driver for it.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "runtime/attach/device_factory.h"

namespace palpate {

struct DeviceRequest {
  std::string name{};        ///< one of known_device_names()
  std::string firmware{};    ///< file; empty: none
  std::string usb{};         ///< as for choose_usb_device(); empty: the only one
  double calibration = 1.0;  ///< [-] [0.2, 5] factor on motor commands
  std::string plane{};       ///< of a device that moves in one; as for parse_plane()
  double homing_s = 60.0;    ///< [s] > 0
  bool event_character = false;                    ///< FalconConfig's
  std::function<void(const std::string&)> tell{};  ///< what the person is to do
  /// The same, and waits until it is done; empty: nobody can be asked.
  std::function<void(const std::string&)> ask{};
  std::function<bool()> stopped{};  ///< while a device opens; empty: never
  bool sign_test = true;            ///< of a real device, at every open (sign_test.h)
};

/// Without hardware.
[[nodiscard]] bool is_emulated(const std::string& name);

/// With commas between them.
[[nodiscard]] std::string known_device_names();

/// @throws InputError for an unknown name or a firmware file that cannot be one;
/// DeviceError where hardware is missing, ambiguous or not permitted.
[[nodiscard]] AttachedDevice choose_device(const DeviceRequest& request);

/// The protocol of a device whose motors have a factor to calibrate, at factor 1. Of an
/// emulated one that nobody holds: it carries 0.3 N of its own and `hung_kg`.
/// @throws InputError for devices that have none, and as choose_device().
[[nodiscard]] std::unique_ptr<DeviceLink> calibration_link(const DeviceRequest& request,
                                                           double hung_kg);

}  // namespace palpate
