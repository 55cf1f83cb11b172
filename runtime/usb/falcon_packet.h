// The 16 bytes that go to a Novint Falcon and come back, and how to find them in a
// stream of bytes.
//
//   offset   to the Falcon                       from the Falcon
//   0        '<'                                 '<'
//   1-12     motors 0, 1, 2                      encoders 0, 1, 2
//   13       'A' + LEDs (bits 1-3) + homing      'A' + buttons (0-3) + homed legs (4-6)
//   14       'A'                                 not known
//   15       '>'                                 '>'
//
// A motor or encoder is an int16 as four nibbles, least significant first, each + 'A'.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace palpate {

constexpr std::size_t kFalconPacketBytes = 16;
using FalconPacket = std::array<std::uint8_t, kFalconPacketBytes>;

constexpr std::uint8_t kFalconGreen = 2;
constexpr std::uint8_t kFalconBlue = 4;
constexpr std::uint8_t kFalconRed = 8;
constexpr std::uint8_t kFalconAllHomed = 7;

struct FalconCommand {
  std::array<std::int16_t, 3> motor{};  ///< [motor counts]
  std::uint8_t leds = 0;                ///< kFalconGreen | kFalconBlue | kFalconRed
  bool homing = true;                   ///< keep looking for the encoders' zero
};

struct FalconReply {
  std::array<std::int16_t, 3> encoder{};  ///< [encoder counts]
  std::uint8_t buttons = 0;               ///< bits 0-3
  std::uint8_t homed = 0;                 ///< bits 0-2, one per leg
};

[[nodiscard]] FalconPacket encode(const FalconCommand& command) noexcept;
[[nodiscard]] FalconPacket encode(const FalconReply& reply) noexcept;

/// Nothing if the frame or a nibble is not as above.
[[nodiscard]] std::optional<FalconReply> decode_reply(
    std::span<const std::uint8_t, kFalconPacketBytes> bytes) noexcept;
[[nodiscard]] std::optional<FalconCommand> decode_command(
    std::span<const std::uint8_t, kFalconPacketBytes> bytes) noexcept;

/// Collects bytes until they make a packet; drops those before a '<' that starts none.
/// No allocation.
class FalconFramer {
 public:
  /// The packet that this byte ends, if its frame is whole.
  [[nodiscard]] std::optional<FalconPacket> add(std::uint8_t byte) noexcept;

  void clear() noexcept { count_ = 0; }

  /// Bytes thrown away to find the next frame.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  void drop_to_next_start() noexcept;

  FalconPacket held_{};
  std::size_t count_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace palpate
