// Devices whose driver is a process of its own: through Haply's service, or through a
// library of their maker.
#pragma once

#include <memory>
#include <string>

#include "runtime/attach/device_factory.h"
#include "runtime/attach/device_request.h"
#include "runtime/device/device_link.h"
#include "runtime/inverse/emulated_inverse.h"

namespace palpate {

/// "haply-inverse:10001" without its port.
[[nodiscard]] std::string device_kind(const std::string& name);

/// With the test of its signs at every open, unless the request has none.
/// @param axes as SignTestOptions::axes.
[[nodiscard]] std::unique_ptr<DeviceLink> sign_tested(const DeviceRequest& request,
                                                      int axes,
                                                      std::unique_ptr<DeviceLink> link);

/// @throws InputError for what the device has not.
[[nodiscard]] AttachedDevice attach_haply_inverse(const DeviceRequest& request);
[[nodiscard]] AttachedDevice attach_dhd(const DeviceRequest& request);
[[nodiscard]] AttachedDevice attach_openhaptics(const DeviceRequest& request);

/// "emulated-inverse". @param service unless null: the one that runs, once the device
/// was made. @param like what it is but for the hand, its start, and its resolution.
[[nodiscard]] AttachedDevice attach_emulated_inverse(
    const DeviceRequest& request, const EmulatedInverseConfig& like,
    std::shared_ptr<EmulatedInverse>* service);

/// The protocol of an emulated service's device that nobody holds; the service lives as
/// long as the link. @throws as attach_haply_inverse().
[[nodiscard]] std::unique_ptr<DeviceLink> free_inverse_link(
    const DeviceRequest& request, SimulatedDeviceConfig dynamics);

/// What the driver program of a device speaks (`palpate-run driver`). @throws as
/// choose_device().
[[nodiscard]] std::unique_ptr<DeviceLink> driver_link(const DeviceRequest& request);

}  // namespace palpate
