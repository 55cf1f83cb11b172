#include "runtime/inverse/inverse_socket.h"

#include <algorithm>
#include <array>
#include <cerrno>

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "runtime/inverse/service_connection.h"
#include "runtime/realtime/clock.h"

namespace palpate {

InverseSocket::InverseSocket(std::uint16_t port, double wait_s)
    : frames_(false),
      leaving_(kInverseMessageBytes + kFrameHeaderBytes),
      mask_(static_cast<unsigned>(inverse_deadline_ns(0.0))) {
  const OpenedWebSocket opened = open_websocket(port, wait_s);
  descriptor_ = opened.descriptor;
  std::copy(opened.rest.begin(), opened.rest.end(), frames_.room().begin());
  frames_.add(opened.rest.size());
}

InverseSocket::~InverseSocket() {
  ::close(descriptor_);
}

void InverseSocket::give_up(const char* why) noexcept {
  if (failure_ == nullptr) {
    failure_ = why;
  }
}

SocketRead InverseSocket::receive(std::string_view& text,
                                  std::int64_t deadline_ns) noexcept {
  MonotonicClock clock;
  while (failure_ == nullptr) {
    switch (frames_.read()) {
      case FrameRead::kMessage:
        text = frames_.payload();
        return SocketRead::kMessage;
      case FrameRead::kPing:
        if (!send_frame(FrameOpcode::kPong, frames_.payload(),
                        inverse_deadline_ns(0.0))) {
          break;
        }
        [[fallthrough]];
      case FrameRead::kPart:
        if (clock.now_ns() > deadline_ns) {  // however many of them there are
          return SocketRead::kNothing;
        }
        break;
      case FrameRead::kIncomplete:
        if (const SocketRead more = read_more(deadline_ns);
            more != SocketRead::kMessage) {
          return more;
        }
        break;
      case FrameRead::kClose:
        give_up("the service closed the session");
        break;
      case FrameRead::kInvalid:
        give_up(frames_.failure());
        break;
    }
  }
  return SocketRead::kLost;
}

// kMessage: there is something more.
SocketRead InverseSocket::read_more(std::int64_t deadline_ns) noexcept {
  if (!wait_for_socket(descriptor_, POLLIN, deadline_ns)) {
    return SocketRead::kNothing;
  }
  const std::span<char> room = frames_.room();
  const ssize_t got = ::recv(descriptor_, room.data(), room.size(), 0);
  if (got > 0) {
    frames_.add(static_cast<std::size_t>(got));
    return SocketRead::kMessage;
  }
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) {
    return SocketRead::kNothing;
  }
  give_up("the connection broke: the service has stopped, or ended the session");
  return SocketRead::kLost;
}

bool InverseSocket::send(std::string_view text, std::int64_t deadline_ns) noexcept {
  if (failure_ == nullptr && text.size() > kInverseMessageBytes) {
    give_up("a message of ours is longer than 64 KiB");
  }
  return failure_ == nullptr && send_frame(FrameOpcode::kText, text, deadline_ns);
}

// Half a frame that stays would spoil all that follow: then the connection is lost.
bool InverseSocket::send_frame(FrameOpcode opcode, std::span<const char> payload,
                               std::int64_t deadline_ns) noexcept {
  // A client masks every frame by four fresh bytes (RFC 6455, 5.3).
  FrameMask mask{};
  for (char& byte : mask) {
    byte = static_cast<char>(mask_() >> 8U);
  }
  const std::size_t size = write_frame(leaving_, opcode, true, payload, &mask);
  std::size_t sent = 0;
  while (sent < size) {
    const ssize_t went =
        ::send(descriptor_, leaving_.data() + sent, size - sent, MSG_NOSIGNAL);
    if (went > 0) {
      sent += static_cast<std::size_t>(went);
    } else if (went < 0 && errno == EAGAIN) {
      if (!wait_for_socket(descriptor_, POLLOUT, deadline_ns)) {
        give_up("the service takes no messages any more");
        return false;
      }
    } else if (went < 0 && errno != EINTR) {
      give_up("the connection broke: the service has stopped, or ended the session");
      return false;
    }
  }
  return true;
}

void InverseSocket::send_close() noexcept {
  constexpr std::array<char, 2> kNormal{0x03, static_cast<char>(0xE8)};  // 1000
  if (failure_ == nullptr) {
    static_cast<void>(
        send_frame(FrameOpcode::kClose, kNormal, inverse_deadline_ns(0.0)));
  }
}

}  // namespace palpate
