// An Inverse3's board in simulation, with the mechanism and the hand that holds it.
// Time is passed in. It has no watchdog: nothing is known of the real one's.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "runtime/emulation/emulated_falcon_board.h"
#include "runtime/emulation/emulated_usb.h"
#include "runtime/emulation/emulated_usb_device.h"
#include "runtime/usb/inverse3_link.h"

namespace palpate {

inline constexpr UsbIdentity kInverse3Identity{.vendor = kInverse3Vendor,
                                               .product = kInverse3Product,
                                               .interface = 1,
                                               .interface_class = 0x0A,
                                               .out = 0x03,
                                               .in = 0x84};

struct Inverse3ModelConfig {
  SimulatedDeviceConfig dynamics{};
  HandScript hand{};                         ///< in Inverse3Link's frame
  Eigen::Vector3d start_m{0.0, 0.15, 0.12};  ///< [m]
  std::int64_t answer_ns = 100'000;          ///< [ns] from command to reply
  int deaf = 2;                              ///< wake-ups without an answer
  bool newer = true;             ///< firmware with another wake-up, and heartbeats
  int heartbeat_every = 3;       ///< replies; of newer firmware
  std::size_t split_bytes = 64;  ///< [1, 64] most of a reply in one packet
  std::int64_t garbage_at = -1;  ///< reply whose bytes are others; -1: none
  std::size_t trace_max = 0;     ///< commands that trace() keeps
};

class Inverse3Model : public UsbModel {
 public:
  explicit Inverse3Model(const Inverse3ModelConfig& config);

  [[nodiscard]] std::vector<std::uint8_t> descriptors() const override {
    return descriptors_of(kInverse3Identity);
  }
  [[nodiscard]] int control(const UsbSetup& setup, std::int64_t now_ns) override;
  [[nodiscard]] int send(std::span<const std::uint8_t> bytes,
                         std::int64_t now_ns) override;
  [[nodiscard]] int receive(std::span<std::uint8_t> packet,
                            std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t next_ns(std::int64_t now_ns) override;

  [[nodiscard]] Eigen::Vector3d force_n() const { return tool_.acting_force_n(); }
  [[nodiscard]] const SimulatedDevice& tool() const noexcept { return tool_; }
  /// The motors' account at every command.
  [[nodiscard]] const std::vector<MotorRecord>& trace() const noexcept {
    return trace_;
  }

 private:
  void wake();
  void obey(std::int64_t now_ns);

  Inverse3ModelConfig config_;
  SetClock clock_;
  SimulatedDevice tool_;
  bool opened_ = false;
  int wakes_ = 0;
  std::int64_t replies_ = 0;
  std::vector<std::uint8_t> heard_;
  std::int64_t ready_ns_ = 0;
  std::deque<std::uint8_t> waiting_;
  std::vector<MotorRecord> trace_;
};

/// The model behind a bad bus and libusb.
class EmulatedInverse3 {
 public:
  EmulatedInverse3(const Inverse3ModelConfig& model, const UsbFaults& bus)
      : model_(model), bus_(model_, bus) {}

  /// A driver for it, which keeps `device`.
  [[nodiscard]] static std::unique_ptr<Inverse3Link> link(
      const std::shared_ptr<EmulatedInverse3>& device, const Inverse3Config& config);

  /// Only while no driver is open, or inside usb().locked().
  [[nodiscard]] const Inverse3Model& model() const noexcept { return model_; }
  [[nodiscard]] const EmulatedUsb& usb() const noexcept { return *usb_; }
  [[nodiscard]] bool kernel_driver_back() const noexcept { return kernel_driver_; }

 private:
  Inverse3Model model_;
  FaultyUsb bus_;
  std::unique_ptr<EmulatedUsb> usb_;
  bool kernel_driver_ = true;
};

}  // namespace palpate
