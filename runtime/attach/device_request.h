// What a person says of a device.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

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
  std::string device_id{};  ///< where a service or library has several; empty: the one
  std::string grip_id{};    ///< the same, of what measures turns
  std::uint16_t events_port = 10020;       ///< of the Inverse service
  std::string profile = "palpate:device";  ///< of its session
  /// The program that drives a device in a process of its own: its subcommand "driver".
  std::string driver_program = "/proc/self/exe";
  bool sign_test = true;  ///< of a real device, at every open (sign_test.h)
};

}  // namespace palpate
