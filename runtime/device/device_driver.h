// A driver process: a device's protocol on one side, the renderer's socket on the other
// (socket_device.h).
#pragma once

#include <cstdint>

#include "runtime/device/device_link.h"

namespace palpate {

struct DriverTiming {
  double rate_max_hz = 4000.0;  ///< [Hz] > 0; a device that is faster waits
  /// [s] >= 0 that the next exchange waits for the force that answers the last one's
  /// position.
  double answer_s = 3e-4;
  double silent_s = 0.02;  ///< [s] > 0 without a command: zero force until the next
};

/// Opens the link and exchanges forces for positions until the socket's other end is
/// closed or the device is lost. Says to the renderer why, whether at opening or later.
/// Every way out puts the device to zero force, as far as the link still can.
/// @param descriptor connected SOCK_SEQPACKET; stays the caller's.
/// @returns an exit code: 0 when the renderer ended it, 5 when the device did.
[[nodiscard]] int serve_device(DeviceLink& link, int descriptor,
                               const DriverTiming& timing);

/// Whether the other end of a socket is closed. Reads nothing.
[[nodiscard]] bool is_hung_up(int descriptor) noexcept;

}  // namespace palpate
