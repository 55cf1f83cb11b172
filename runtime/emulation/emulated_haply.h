// A Haply 2diy in simulation: board, pantograph and the hand that holds it, in the
// plane z = 0. Time is passed in. As the real board, it has no watchdog.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/emulation/emulated_serial_board.h"
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
  double counts_per_turn = 13'824.0;  ///< [0, inf) of its encoders; 0: any angle
  std::int64_t answer_ns = 100'000;   ///< [ns] from command to reply
  std::size_t split_bytes = 64;       ///< [1, 64] most of a reply in one packet
  std::size_t trace_max = 0;          ///< commands that trace() keeps
};

class HaplyModel : public SerialBoard {
 public:
  explicit HaplyModel(const HaplyModelConfig& config);

  [[nodiscard]] std::vector<std::uint8_t> descriptors() const override {
    return descriptors_of(kHaplyIdentity);
  }
  [[nodiscard]] int send(std::span<const std::uint8_t> bytes,
                         std::int64_t now_ns) override;

  [[nodiscard]] const std::array<double, 2>& torque_nm() const noexcept {
    return torque_nm_;
  }

 private:
  void obey(std::int64_t now_ns);
  [[nodiscard]] double counted_deg(double theta_rad) const;

  HaplyModelConfig config_;
  bool set_up_ = false;
  std::uint8_t id_ = 0;
  std::array<double, 2> torque_nm_{};
  PantographPose pose_;
};

using EmulatedHaply = EmulatedBoard<HaplyModel, HaplyLink>;

}  // namespace palpate
