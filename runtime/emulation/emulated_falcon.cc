#include "runtime/emulation/emulated_falcon.h"

namespace palpate {

std::unique_ptr<FalconLink> EmulatedFalcon::link(
    const std::shared_ptr<EmulatedFalcon>& falcon, const FalconConfig& config) {
  return std::make_unique<FalconLink>(
      config,
      [falcon] {
        falcon->usb_ = std::make_unique<EmulatedUsb>(falcon->bus_);
        return falcon->usb_->descriptor();
      },
      [falcon](int /*descriptor*/) {
        falcon->kernel_driver_ = falcon->usb_->kernel_driver();
        falcon->usb_.reset();
      });
}

std::vector<std::uint8_t> emulated_firmware() {
  return {kEmulatedFirmware.begin(), kEmulatedFirmware.end()};
}

}  // namespace palpate
