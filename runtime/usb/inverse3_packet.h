// What goes to an Inverse3's own board and comes back: no frame, no checksum; reals are
// float32, least significant byte first. As found in InfinyTech3D/SofaHaplyRobotics and
// chohh7391/lerobot_teleoperator_inverse3; the maker documents none of it.
//
//   wake-up  0A; answered by 0A and 21 bytes (id, model, hardware, firmware, a
//            quaternion), in newer firmware by 0A and others
//   force    2A, 3 reals [N]; answered by 2B, position [m], velocity [m/s]
//   newer firmware puts BA 02 02 and two bytes between answers
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <Eigen/Core>

namespace palpate {

constexpr std::uint8_t kInverse3Wake = 0x0A;
constexpr std::size_t kInverse3WakeBytes = 22;  // of the answer of older firmware
constexpr std::uint8_t kInverse3Force = 0x2A;
constexpr std::uint8_t kInverse3State = 0x2B;
constexpr std::size_t kInverse3ForceBytes = 13;
constexpr std::size_t kInverse3StateBytes = 25;
constexpr std::array<std::uint8_t, 3> kInverse3Heartbeat{0xBA, 0x02, 0x02};
constexpr std::size_t kInverse3HeartbeatBytes = 5;

using Inverse3State = std::array<std::uint8_t, kInverse3StateBytes>;

/// @param force_n [N] in the device's axes; what is not finite is zero.
[[nodiscard]] std::array<std::uint8_t, kInverse3ForceBytes> encode_inverse3_force(
    const Eigen::Vector3d& force_n) noexcept;
[[nodiscard]] Eigen::Vector3d decode_inverse3_force(
    std::span<const std::uint8_t, kInverse3ForceBytes> bytes) noexcept;

[[nodiscard]] Inverse3State encode_inverse3_state(
    const Eigen::Vector3d& position_m,
    const Eigen::Vector3d& velocity_m_per_s) noexcept;

/// [m] in the device's axes. Nothing for what cannot be: another first byte, a
/// coordinate beyond 1 m, a speed beyond 20 m/s.
[[nodiscard]] std::optional<Eigen::Vector3d> decode_inverse3_position(
    std::span<const std::uint8_t, kInverse3StateBytes> bytes) noexcept;

/// Takes bytes as they come, hands out states.
class Inverse3Framer {
 public:
  enum class Found : std::uint8_t { kNothing, kState, kNonsense };

  /// Adds a byte. After kNonsense it is out of step: clear() when the line is quiet.
  [[nodiscard]] Found take(std::uint8_t byte) noexcept;
  [[nodiscard]] const Inverse3State& state() const noexcept { return bytes_; }
  void clear() noexcept { size_ = 0; }

 private:
  Inverse3State bytes_{};
  std::size_t size_ = 0;
};

}  // namespace palpate
