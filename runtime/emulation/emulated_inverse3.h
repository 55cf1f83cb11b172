// An Inverse3's board in simulation, with the mechanism and the hand that holds it.
// Time is passed in. It has no watchdog: nothing is known of the real one's.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/emulation/emulated_serial_board.h"
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
  bool newer = true;               ///< firmware with another wake-up, and heartbeats
  int heartbeat_every = 3;         ///< replies; of newer firmware
  std::size_t split_bytes = 64;    ///< [1, 64] most of a reply in one packet
  std::int64_t garbage_at = -1;    ///< reply whose bytes are others; -1: none
  std::int64_t garbage_count = 1;  ///< from there on
  std::size_t trace_max = 0;       ///< commands that trace() keeps
};

class Inverse3Model : public SerialBoard {
 public:
  explicit Inverse3Model(const Inverse3ModelConfig& config);

  [[nodiscard]] std::vector<std::uint8_t> descriptors() const override {
    return descriptors_of(kInverse3Identity);
  }
  [[nodiscard]] int send(std::span<const std::uint8_t> bytes,
                         std::int64_t now_ns) override;

  [[nodiscard]] Eigen::Vector3d force_n() const { return tool().acting_force_n(); }

 private:
  void wake();
  void obey(std::int64_t now_ns);

  Inverse3ModelConfig config_;
  int wakes_ = 0;
  std::int64_t replies_ = 0;
};

using EmulatedInverse3 = EmulatedBoard<Inverse3Model, Inverse3Link>;

}  // namespace palpate
