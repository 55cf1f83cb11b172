#include "runtime/usb/falcon_packet.h"

#include <algorithm>

namespace palpate {
namespace {

constexpr std::uint8_t kStart = '<';
constexpr std::uint8_t kEnd = '>';
constexpr std::uint8_t kZero = 'A';
constexpr std::size_t kNibbles = 4;

void put_nibbles(FalconPacket& packet, std::size_t which, std::int16_t value) noexcept {
  auto bits = static_cast<std::uint16_t>(value);
  for (std::size_t i = 0; i < kNibbles; ++i) {
    packet[1 + kNibbles * which + i] = static_cast<std::uint8_t>(kZero + (bits & 0xF));
    bits = static_cast<std::uint16_t>(bits >> 4);
  }
}

std::optional<std::int16_t> get_nibbles(
    std::span<const std::uint8_t, kFalconPacketBytes> bytes,
    std::size_t which) noexcept {
  unsigned bits = 0;
  for (std::size_t i = kNibbles; i-- > 0;) {
    const std::uint8_t byte = bytes[1 + kNibbles * which + i];
    if (byte < kZero || byte > kZero + 0xF) {
      return std::nullopt;
    }
    bits = bits << 4 | static_cast<unsigned>(byte - kZero);
  }
  return static_cast<std::int16_t>(bits);
}

FalconPacket framed(const std::array<std::int16_t, 3>& values,
                    std::uint8_t state) noexcept {
  FalconPacket packet{};
  packet.front() = kStart;
  for (std::size_t i = 0; i < values.size(); ++i) {
    put_nibbles(packet, i, values[i]);
  }
  packet[13] = static_cast<std::uint8_t>(kZero + state);
  packet[14] = kZero;
  packet.back() = kEnd;
  return packet;
}

std::optional<std::array<std::int16_t, 3>> values_of(
    std::span<const std::uint8_t, kFalconPacketBytes> bytes) noexcept {
  if (bytes.front() != kStart || bytes.back() != kEnd || bytes[13] < kZero) {
    return std::nullopt;
  }
  std::array<std::int16_t, 3> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto value = get_nibbles(bytes, i);
    if (!value) {
      return std::nullopt;
    }
    values[i] = *value;
  }
  return values;
}

}  // namespace

FalconPacket encode(const FalconCommand& command) noexcept {
  return framed(command.motor, static_cast<std::uint8_t>((command.leds & 0xE) |
                                                         (command.homing ? 1 : 0)));
}

FalconPacket encode(const FalconReply& reply) noexcept {
  return framed(reply.encoder, static_cast<std::uint8_t>((reply.buttons & 0xF) |
                                                         (reply.homed & 7) << 4));
}

std::optional<FalconReply> decode_reply(
    std::span<const std::uint8_t, kFalconPacketBytes> bytes) noexcept {
  const auto values = values_of(bytes);
  const int state = bytes[13] - kZero;
  if (!values || state > 0x7F) {
    return std::nullopt;
  }
  return FalconReply{.encoder = *values,
                     .buttons = static_cast<std::uint8_t>(state & 0xF),
                     .homed = static_cast<std::uint8_t>(state >> 4)};
}

std::optional<FalconCommand> decode_command(
    std::span<const std::uint8_t, kFalconPacketBytes> bytes) noexcept {
  const auto values = values_of(bytes);
  const int state = bytes[13] - kZero;
  if (!values || state > 0xF) {
    return std::nullopt;
  }
  return FalconCommand{.motor = *values,
                       .leds = static_cast<std::uint8_t>(state & 0xE),
                       .homing = (state & 1) != 0};
}

std::optional<FalconPacket> FalconFramer::add(std::uint8_t byte) noexcept {
  if (count_ == 0 && byte != kStart) {
    ++dropped_;
    return std::nullopt;
  }
  held_[count_++] = byte;
  if (count_ < kFalconPacketBytes) {
    return std::nullopt;
  }
  if (byte == kEnd) {
    count_ = 0;
    return held_;
  }
  drop_to_next_start();
  return std::nullopt;
}

void FalconFramer::drop_to_next_start() noexcept {
  const auto end = held_.begin() + count_;
  const auto start = std::find(held_.begin() + 1, end, kStart);
  dropped_ += static_cast<std::uint64_t>(start - held_.begin());
  count_ = static_cast<std::size_t>(end - start);
  std::copy(start, end, held_.begin());
}

}  // namespace palpate
