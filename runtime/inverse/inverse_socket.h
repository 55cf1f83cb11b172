// A WebSocket client for a service on this machine (RFC 6455), for a loop. All memory
// is taken in the constructor, and every call has a deadline. A message that is half
// there at its deadline goes on arriving in the next call.
//
// Boost.Beast's WebSocket streams are not used: a read of theirs that runs into a
// deadline spoils the stream, and one that is left pending allocates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <string_view>
#include <vector>

#include "runtime/inverse/websocket_frame.h"

namespace palpate {

enum class SocketRead : std::uint8_t {
  kMessage,
  kNothing,  ///< the deadline passed
  kLost,     ///< for good; failure() says why
};

class InverseSocket {
 public:
  /// Connects to ws://127.0.0.1:`port`/ within `wait_s`. @throws DeviceError.
  InverseSocket(std::uint16_t port, double wait_s);
  ~InverseSocket();
  InverseSocket(const InverseSocket&) = delete;
  InverseSocket& operator=(const InverseSocket&) = delete;

  /// The next text message, in memory of this object until the next call.
  [[nodiscard]] SocketRead receive(std::string_view& text,
                                   std::int64_t deadline_ns) noexcept;

  /// A text message of at most 64 KiB. False when it could not leave: lost.
  [[nodiscard]] bool send(std::string_view text, std::int64_t deadline_ns) noexcept;

  /// Says that it goes, where that can be said at once.
  void send_close() noexcept;

  /// Null while all was well.
  [[nodiscard]] const char* failure() const noexcept { return failure_; }

 private:
  [[nodiscard]] SocketRead read_more(std::int64_t deadline_ns) noexcept;
  [[nodiscard]] bool send_frame(FrameOpcode opcode, std::span<const char> payload,
                                std::int64_t deadline_ns) noexcept;
  void give_up(const char* why) noexcept;

  int descriptor_ = -1;
  const char* failure_ = nullptr;
  WebsocketReader frames_;
  std::vector<char> leaving_;
  std::minstd_rand mask_;
};

}  // namespace palpate
