// What goes to a Haply board and comes back: no frame, no checksum, lengths fixed by
// the set-up. Integers are bytes, reals float32, least significant byte first.
//
//   set-up   1, id, motor ports, a direction per motor, encoder ports, a direction per
//            encoder, inputs and their pins, PWMs and their pins, per encoder offset
//            [degrees] and counts per turn
//   torques  2, id, a byte per PWM, torque [N m] per motor; answered by
//            id, a real per input, angle [degrees] per encoder
//   reset    0, id
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace palpate {

/// Largest torque of a motor; the board clamps at it, too.
constexpr double kHaplyTorqueMaxNm = 0.123;

/// A board with two motors, each with an encoder: the 2diy.
struct HaplySetup {
  std::uint8_t id = 5;
  std::array<std::uint8_t, 2> motor_direction{};
  std::array<std::uint8_t, 2> encoder_direction{};
  std::array<double, 2> offset_deg{180.0, 0.0};  ///< [degrees] angle at the stop
  double counts_per_turn = 13'824.0;             ///< (0, inf)
};

constexpr std::size_t kHaplySetupBytes = 26;
constexpr std::size_t kHaplyTorqueBytes = 10;
constexpr std::size_t kHaplyReplyBytes = 9;
constexpr std::size_t kHaplyResetBytes = 2;

[[nodiscard]] std::array<std::uint8_t, kHaplySetupBytes> encode(
    const HaplySetup& setup) noexcept;

/// @param torque_nm [N m] clamped to +-kHaplyTorqueMaxNm; what is not finite is zero.
[[nodiscard]] std::array<std::uint8_t, kHaplyTorqueBytes> encode_torques(
    std::uint8_t id, const std::array<double, 2>& torque_nm) noexcept;

[[nodiscard]] std::array<std::uint8_t, kHaplyReplyBytes> encode_angles(
    std::uint8_t id, const std::array<double, 2>& angle_deg) noexcept;

/// Angles [degrees]. Nothing if the id is another, or an angle is not finite or beyond
/// ten turns: then the stream is out of step.
[[nodiscard]] std::optional<std::array<double, 2>> decode_angles(
    std::uint8_t id, std::span<const std::uint8_t, kHaplyReplyBytes> bytes) noexcept;

/// Torques [N m] of a torque command.
[[nodiscard]] std::array<double, 2> decode_torques(
    std::span<const std::uint8_t, kHaplyTorqueBytes> bytes) noexcept;

}  // namespace palpate
