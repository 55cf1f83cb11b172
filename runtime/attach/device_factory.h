// A device that is chosen but not open yet, and how it comes to lie in a body's frame.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "runtime/attach/placed_device.h"
#include "runtime/device/device.h"
#include "runtime/device/device_link.h"
#include "runtime/device/driven_device.h"
#include "runtime/hand/hand_script.h"

namespace palpate {

/// A driver that is not open yet. For an emulated device the hand that holds it follows
/// the script, which is in the body's frame; positions and forces are, too.
struct AttachedDevice {
  DeviceLimits limits;
  std::function<std::unique_ptr<Device>(const HandScript&)> make;
};

/// Its protocol; for an emulated device the script is in the device's frame.
using MakeLink = std::function<std::unique_ptr<DeviceLink>(const HandScript&)>;

/// The device that speaks a protocol in a thread of its own, with its middle placed
/// over what the script presses. @param rest_m middle of the workspace [m]. @param
/// plane of the body that the device's x-y plane is.
[[nodiscard]] AttachedDevice attach(const DeviceLimits& limits,
                                    const Eigen::Vector3d& rest_m, const MakeLink& link,
                                    const std::optional<SectionPlane>& plane = {});

/// Its driver program; for an emulated device the script is in the device's frame.
using MakeDriver = std::function<DriverProgram(const HandScript&)>;

/// The same with a driver in a process of its own.
[[nodiscard]] AttachedDevice attach_driven(const DeviceLimits& limits,
                                           const Eigen::Vector3d& rest_m,
                                           const MakeDriver& driver);

}  // namespace palpate
