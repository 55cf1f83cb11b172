// A Haply 2diy in simulation: board, pantograph and the hand that holds it, in the
// plane z = 0. Time is passed in. As the real board, it has no watchdog.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "runtime/emulation/emulated_falcon_board.h"
#include "runtime/emulation/emulated_usb.h"
#include "runtime/emulation/emulated_usb_device.h"
#include "runtime/usb/haply_link.h"

namespace palpate {

inline constexpr UsbIdentity kHaplyIdentity{.vendor = 0x2341,
                                            .product = 0x003E,
                                            .interface = 1,
                                            .interface_class = 0x0A,
                                            .out = 0x02,
                                            .in = 0x83};

struct HaplyModelConfig {
  SimulatedDeviceConfig dynamics{};
  HandScript hand{};                        ///< in the device's frame
  Eigen::Vector3d start_m{0.0, 0.09, 0.0};  ///< [m]
  PantographLinks links{};
  std::int64_t answer_ns = 100'000;  ///< [ns] from command to reply
  std::size_t split_bytes = 64;      ///< [1, 64] most of a reply in one packet
  std::size_t trace_max = 0;         ///< commands that trace() keeps
};

class HaplyModel : public UsbModel {
 public:
  explicit HaplyModel(const HaplyModelConfig& config);

  [[nodiscard]] std::vector<std::uint8_t> descriptors() const override {
    return descriptors_of(kHaplyIdentity);
  }
  [[nodiscard]] int control(const UsbSetup& setup, std::int64_t now_ns) override;
  [[nodiscard]] int send(std::span<const std::uint8_t> bytes,
                         std::int64_t now_ns) override;
  [[nodiscard]] int receive(std::span<std::uint8_t> packet,
                            std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t next_ns(std::int64_t now_ns) override;

  [[nodiscard]] const std::array<double, 2>& torque_nm() const noexcept {
    return torque_nm_;
  }
  [[nodiscard]] const SimulatedDevice& tool() const noexcept { return tool_; }
  /// The motors' account at every command.
  [[nodiscard]] const std::vector<MotorRecord>& trace() const noexcept {
    return trace_;
  }

 private:
  void obey(std::int64_t now_ns);

  HaplyModelConfig config_;
  SetClock clock_;
  SimulatedDevice tool_;
  bool opened_ = false;
  bool set_up_ = false;
  std::uint8_t id_ = 0;
  std::vector<std::uint8_t> heard_;
  std::array<double, 2> torque_nm_{};
  PantographPose pose_;
  std::int64_t ready_ns_ = 0;
  std::deque<std::uint8_t> waiting_;
  std::vector<MotorRecord> trace_;
};

/// The model behind a bad bus and libusb.
class EmulatedHaply {
 public:
  EmulatedHaply(const HaplyModelConfig& model, const UsbFaults& bus)
      : model_(model), bus_(model_, bus) {}

  /// A driver for it, which keeps `haply`.
  [[nodiscard]] static std::unique_ptr<HaplyLink> link(
      const std::shared_ptr<EmulatedHaply>& haply, const HaplyConfig& config);

  [[nodiscard]] const HaplyModel& model() const noexcept { return model_; }
  [[nodiscard]] const EmulatedUsb& usb() const noexcept { return *usb_; }
  [[nodiscard]] bool kernel_driver_back() const noexcept { return kernel_driver_; }

 private:
  HaplyModel model_;
  FaultyUsb bus_;
  std::unique_ptr<EmulatedUsb> usb_;
  bool kernel_driver_ = true;
};

}  // namespace palpate
