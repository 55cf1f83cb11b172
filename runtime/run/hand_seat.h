// The devices of a run, from what is known before the body is to what the hands hold.
// For the sources of this folder.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "runtime/run/prepared_run.h"

namespace palpate {

/// A hand's device, as far as it is one before somebody knows what it presses.
struct HandSeat {
  DeviceLimits limits;
  std::unique_ptr<Device> connected = nullptr;  // by a socket
  const AttachedDevice* attached = nullptr;
};

/// @throws InputError, DeviceError where a socket does not answer.
[[nodiscard]] HandSeat seat_of(const SimulationOptions& options,
                               const std::filesystem::path& socket,
                               const std::optional<AttachedDevice>& attached);

/// The device itself. @param several a simulated hand turns its tool.
[[nodiscard]] std::unique_ptr<Device> make_device(const SimulationOptions& options,
                                                  HandSeat& seat,
                                                  const HandScript& script,
                                                  bool several, Clock& clock);

/// A simulated hand that wanders over the body. @throws InputError where a device is
/// held, or the body is not in memory.
[[nodiscard]] std::unique_ptr<Device> wandering_device(
    const PressedBody& body, const SimulationOptions& options,
    const SimulatedDeviceConfig& config, Clock& clock);

/// Of two devices the one that renders less.
[[nodiscard]] DeviceLimits weaker(const DeviceLimits& a, const DeviceLimits& b,
                                  double hold_s);

/// Whether a hand's device is simulated. @param hand 0 or 1.
[[nodiscard]] bool is_simulated(const SimulationOptions& options, int hand);

/// All hands' devices.
[[nodiscard]] bool are_simulated(const SimulationOptions& options);

}  // namespace palpate
