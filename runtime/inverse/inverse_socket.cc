#include "runtime/inverse/inverse_socket.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "runtime/inverse/inverse_message.h"
#include "runtime/inverse/service_connection.h"
#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

constexpr unsigned kText = 1;
constexpr unsigned kContinuation = 0;
constexpr unsigned kClose = 8;
constexpr unsigned kPing = 9;
constexpr unsigned kPong = 10;
constexpr std::size_t kHeaderBytes = 14;  // of a frame, at most

}  // namespace

InverseSocket::InverseSocket(std::uint16_t port, double wait_s)
    : arrived_(2 * kInverseMessageBytes),
      message_(kInverseMessageBytes),
      leaving_(kInverseMessageBytes + kHeaderBytes),
      mask_(static_cast<unsigned>(inverse_deadline_ns(0.0))) {
  const OpenedWebSocket opened = open_websocket(port, wait_s);
  descriptor_ = opened.descriptor;
  std::copy(opened.rest.begin(), opened.rest.end(), arrived_.begin());
  end_ = opened.rest.size();
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
    switch (take_frame()) {
      case Frame::kMessage:
        text = {message_.data(), std::exchange(message_size_, 0)};
        return SocketRead::kMessage;
      case Frame::kControl:
        if (clock.now_ns() > deadline_ns) {  // however many of them there are
          return SocketRead::kNothing;
        }
        break;
      case Frame::kIncomplete:
        if (const SocketRead more = read_more(deadline_ns);
            more != SocketRead::kMessage) {
          return more;
        }
        break;
      case Frame::kLost:
        break;
    }
  }
  return SocketRead::kLost;
}

// kMessage: there is something more.
SocketRead InverseSocket::read_more(std::int64_t deadline_ns) noexcept {
  std::copy(arrived_.begin() + static_cast<std::ptrdiff_t>(begin_),
            arrived_.begin() + static_cast<std::ptrdiff_t>(end_), arrived_.begin());
  end_ -= std::exchange(begin_, 0);
  if (!wait_for_socket(descriptor_, POLLIN, deadline_ns)) {
    return SocketRead::kNothing;
  }
  const ssize_t got =
      ::recv(descriptor_, arrived_.data() + end_, arrived_.size() - end_, 0);
  if (got > 0) {
    end_ += static_cast<std::size_t>(got);
    return SocketRead::kMessage;
  }
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) {
    return SocketRead::kNothing;
  }
  give_up("the connection broke: the service has stopped, or ended the session");
  return SocketRead::kLost;
}

InverseSocket::Frame InverseSocket::take_frame() noexcept {
  const std::span<const char> bytes(arrived_.data() + begin_, end_ - begin_);
  const auto byte = [&bytes](std::size_t i) {
    return static_cast<unsigned>(static_cast<unsigned char>(bytes[i]));
  };
  if (bytes.size() < 2) {
    return Frame::kIncomplete;
  }
  const unsigned opcode = byte(0) & 0x0FU;
  const bool final = (byte(0) & 0x80U) != 0;
  std::uint64_t length = byte(1) & 0x7FU;
  const std::size_t extra = length == 126 ? 2 : length == 127 ? 8 : 0;
  if ((byte(0) & 0x70U) != 0 || (byte(1) & 0x80U) != 0 ||
      (opcode >= kClose && (!final || extra > 0))) {
    give_up("a frame that is none of the protocol's");
    return Frame::kLost;
  }
  if (bytes.size() < 2 + extra) {
    return Frame::kIncomplete;
  }
  if (extra > 0) {
    length = 0;
    for (std::size_t i = 0; i < extra; ++i) {
      length = length << 8U | byte(2 + i);
    }
  }
  if (length > kInverseMessageBytes) {
    give_up("a message of more than 64 KiB");
    return Frame::kLost;
  }
  const std::size_t header = 2 + extra;
  if (bytes.size() < header + length) {
    return Frame::kIncomplete;
  }
  begin_ += header + length;
  return take_payload(opcode, final, bytes.subspan(header, length));
}

InverseSocket::Frame InverseSocket::take_payload(
    unsigned opcode, bool final, std::span<const char> payload) noexcept {
  if (opcode == kPing || opcode == kPong) {
    if (opcode == kPing && !send_frame(kPong, payload, inverse_deadline_ns(0.0))) {
      return Frame::kLost;
    }
    return Frame::kControl;
  }
  if (opcode == kClose) {
    give_up("the service closed the session");
    return Frame::kLost;
  }
  if (opcode != (message_begun_ ? kContinuation : kText)) {
    give_up("a message that is no text");
    return Frame::kLost;
  }
  if (message_size_ + payload.size() > kInverseMessageBytes) {
    give_up("a message of more than 64 KiB");
    return Frame::kLost;
  }
  std::copy(payload.begin(), payload.end(),
            message_.begin() + static_cast<std::ptrdiff_t>(message_size_));
  message_size_ += payload.size();
  message_begun_ = !final;
  return final ? Frame::kMessage : Frame::kControl;
}

bool InverseSocket::send(std::string_view text, std::int64_t deadline_ns) noexcept {
  if (failure_ == nullptr && text.size() > kInverseMessageBytes) {
    give_up("a message of ours is longer than 64 KiB");
  }
  return failure_ == nullptr && send_frame(kText, text, deadline_ns);
}

// Half a frame that stays would spoil all that follow: then the connection is lost.
bool InverseSocket::send_frame(unsigned opcode, std::span<const char> payload,
                               std::int64_t deadline_ns) noexcept {
  std::size_t size = 0;
  const auto put = [&](std::size_t byte) {
    leaving_[size++] = static_cast<char>(byte);
  };
  put(0x80U | opcode);
  if (payload.size() < 126) {
    put(0x80U | payload.size());
  } else {
    const bool wide = payload.size() > 0xFFFF;
    put(0x80U | (wide ? 127U : 126U));
    for (unsigned shift = wide ? 64 : 16; shift > 0; shift -= 8) {
      put(static_cast<std::uint64_t>(payload.size()) >> (shift - 8) & 0xFFU);
    }
  }
  std::array<char, 4> mask{};
  for (char& byte : mask) {
    byte = static_cast<char>(mask_() >> 8U);
    put(static_cast<unsigned char>(byte));
  }
  for (std::size_t i = 0; i < payload.size(); ++i) {
    leaving_[size++] = static_cast<char>(payload[i] ^ mask[i % 4]);
  }
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
    static_cast<void>(send_frame(kClose, kNormal, inverse_deadline_ns(0.0)));
  }
}

}  // namespace palpate
