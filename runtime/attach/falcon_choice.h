// A Falcon as a user asks for it.
#pragma once

#include "runtime/attach/device_choice.h"
#include "runtime/usb/falcon_link.h"

namespace palpate {

/// Says which firmware it reads. @throws InputError for what is out of range or no
/// Falcon's.
[[nodiscard]] FalconConfig falcon_config(const DeviceRequest& request);

}  // namespace palpate
