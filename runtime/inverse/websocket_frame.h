// Frames of a WebSocket (RFC 6455, section 5), for either end of one. Memory is taken
// in constructors alone.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "runtime/inverse/inverse_message.h"

namespace palpate {

enum class FrameOpcode : std::uint8_t {
  kContinuation = 0,
  kText = 1,
  kClose = 8,
  kPing = 9,
  kPong = 10,
};

/// Why an end closes (RFC 6455, section 7.4.1).
enum class CloseCode : std::uint16_t {
  kProtocol = 1002,
  kNoText = 1003,
  kPolicy = 1008,
  kTooLong = 1009,
  kTryAgainLater = 1013,
};

using FrameMask = std::array<char, 4>;

constexpr std::size_t kFrameHeaderBytes = 14;  ///< at most

/// Writes a frame to `to`, which holds `payload` and a header. @param last of a
/// message.
/// @param mask null: none, as servers have it. @returns bytes written.
std::size_t write_frame(std::span<char> to, FrameOpcode opcode, bool last,
                        std::span<const char> payload, const FrameMask* mask) noexcept;

enum class FrameRead : std::uint8_t {
  kMessage,
  kPart,  ///< of a message, or a pong
  kPing,
  kClose,
  kIncomplete,
  kInvalid,  ///< for good; failure() says why
};

/// Takes frames out of bytes that arrive, and text messages out of frames.
class WebsocketReader {
 public:
  /// @param masked whether the other end masks, which clients do.
  /// @param message_max bytes of a message.
  explicit WebsocketReader(bool masked, std::size_t message_max = kInverseMessageBytes)
      : masked_(masked), arrived_(2 * message_max), message_(message_max) {}

  /// Where bytes may arrive, and how many of them did. Ends what payload() said.
  [[nodiscard]] std::span<char> room() noexcept;
  void add(std::size_t bytes) noexcept { end_ += bytes; }

  /// Reads the next frame.
  [[nodiscard]] FrameRead read() noexcept;

  /// Of the message, the ping or the close frame that read() has found.
  [[nodiscard]] std::string_view payload() const noexcept { return payload_; }
  [[nodiscard]] const char* failure() const noexcept { return failure_; }
  [[nodiscard]] CloseCode failure_code() const noexcept { return failure_code_; }

 private:
  [[nodiscard]] FrameRead refuse(CloseCode code, const char* why) noexcept;
  [[nodiscard]] FrameRead take(unsigned opcode, bool last,
                               std::span<const char> payload) noexcept;

  bool masked_;
  const char* failure_ = nullptr;
  CloseCode failure_code_ = CloseCode::kProtocol;
  std::vector<char> arrived_;  // bytes not looked at yet: [begin_, end_)
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::vector<char> message_;  // frames of a message so far
  std::size_t message_size_ = 0;
  bool message_begun_ = false;
  std::string_view payload_;
};

}  // namespace palpate
