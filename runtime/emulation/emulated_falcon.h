// A Falcon without hardware: the model behind libusb, with the driver of the real one.
#pragma once

#include <memory>

#include "runtime/device/threaded_device.h"
#include "runtime/emulation/emulated_falcon_board.h"
#include "runtime/emulation/emulated_usb.h"
#include "runtime/usb/falcon_link.h"

namespace palpate {

struct EmulatedFalconConfig {
  FalconModelConfig model{};
  SerialFaults line{};
  UsbFaults bus{};
};

/// The model and its bus; a new connection each time that a driver opens it.
class EmulatedFalcon {
 public:
  explicit EmulatedFalcon(const EmulatedFalconConfig& config)
      : model_(config.model),
        chip_(model_, kFalconIdentity, config.line),
        bus_(chip_, config.bus) {}

  /// A driver for it. `falcon` must be held by a shared pointer, which the driver
  /// keeps.
  [[nodiscard]] static std::unique_ptr<FalconLink> link(
      const std::shared_ptr<EmulatedFalcon>& falcon, const FalconConfig& config);

  /// Only while no driver is open, or inside usb().locked().
  [[nodiscard]] const FalconModel& model() const noexcept { return model_; }
  [[nodiscard]] const FaultyUsb& bus() const noexcept { return bus_; }
  [[nodiscard]] const EmulatedUsb& usb() const noexcept { return *usb_; }
  /// The kernel's driver was bound again when the last connection ended.
  [[nodiscard]] bool kernel_driver_back() const noexcept { return kernel_driver_; }

 private:
  FalconModel model_;
  FtdiChip chip_;
  FaultyUsb bus_;
  std::unique_ptr<EmulatedUsb> usb_;
  bool kernel_driver_ = true;
};

/// [s] FalconConfig::answer_s: threads pause where hardware does not.
constexpr double kEmulatedAnswerS = 0.02;

/// kEmulatedFirmware as bytes.
[[nodiscard]] std::vector<std::uint8_t> emulated_firmware();

}  // namespace palpate
