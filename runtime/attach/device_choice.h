// From a device's name to a driver for it.
#pragma once

#include <memory>
#include <string>

#include "runtime/attach/device_factory.h"
#include "runtime/attach/device_request.h"
#include "runtime/emulation/emulated_haply.h"
#include "runtime/emulation/emulated_inverse3.h"

namespace palpate {

/// Without hardware.
[[nodiscard]] bool is_emulated(const std::string& name);

/// Its x-y plane.
[[nodiscard]] bool moves_in_a_plane(const std::string& name);

/// With commas between them.
[[nodiscard]] std::string known_device_names();

/// @throws InputError for an unknown name or a firmware file that cannot be one;
/// DeviceError where hardware is missing, ambiguous or not permitted.
[[nodiscard]] AttachedDevice choose_device(const DeviceRequest& request);

/// "emulated-haply". @param haply unless null: the board, once the device was made.
/// @param trace_max commands of which it keeps the motors' account.
[[nodiscard]] AttachedDevice attach_emulated_haply(
    const DeviceRequest& request, std::size_t trace_max,
    std::shared_ptr<EmulatedHaply>* haply);

/// "emulated-inverse3", the same.
[[nodiscard]] AttachedDevice attach_emulated_inverse3(
    const DeviceRequest& request, std::size_t trace_max,
    std::shared_ptr<EmulatedInverse3>* board);

/// The protocol of a device whose motors have a factor to calibrate, at factor 1. Of an
/// emulated one that nobody holds: it carries 0.3 N of its own and `hung_kg`.
/// @throws InputError for devices that have none, and as choose_device().
[[nodiscard]] std::unique_ptr<DeviceLink> calibration_link(const DeviceRequest& request,
                                                           double hung_kg);

/// The protocol of a device that is probed (probe.h); of an emulated one that nobody
/// holds. @throws InputError for what is no known device, and as choose_device().
[[nodiscard]] std::unique_ptr<DeviceLink> probe_link(const DeviceRequest& request);

}  // namespace palpate
