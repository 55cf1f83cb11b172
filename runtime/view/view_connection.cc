// Connections to the live view's server.
#include <algorithm>
#include <array>
#include <cerrno>
#include <span>
#include <utility>

#include <sys/socket.h>
#include <unistd.h>

#include "runtime/inverse/websocket_handshake.h"
#include "runtime/view/view_server_parts.h"

namespace palpate {

ViewServer::Parts::Connection::Connection(Parts& parts, int descriptor)
    : parts_(parts),
      descriptor_(descriptor),
      deadline_ns_(parts.clock.now_ns() + kRequestNs),
      rate_(parts.options.messages_per_s_max) {}

ViewServer::Parts::Connection::~Connection() {
  ::close(descriptor_);
}

pollfd ViewServer::Parts::Connection::waits_for() const {
  const bool more = sent_ < leaving_.size() || pong_ || !waiting_.empty() || latest_;
  const int reads = phase_ == Phase::kAnswer ? 0 : POLLIN;
  return {descriptor_, static_cast<short>(reads | (more ? POLLOUT : 0)), 0};
}

std::int64_t ViewServer::Parts::Connection::due_ns() const {
  return deadline_ns_ - (phase_ == Phase::kOpen && !asked_ ? kIdleNs / 2 : 0);
}

void ViewServer::Parts::Connection::serve(bool came) {
  if (came && phase_ != Phase::kAnswer) {
    read();
  }
  keep_time();
  write();
}

void ViewServer::Parts::Connection::read() {
  const std::span<char> room = frames_.room();
  const ssize_t got = ::recv(descriptor_, room.data(), room.size(), 0);
  if (got <= 0) {
    phase_ = got < 0 && (errno == EAGAIN || errno == EINTR) ? phase_ : Phase::kEnded;
  } else if (phase_ == Phase::kHead) {
    head_.append(room.data(), static_cast<std::size_t>(got));
    read_request();
  } else if (phase_ == Phase::kOpen) {
    deadline_ns_ = parts_.clock.now_ns() + kIdleNs;
    asked_ = false;
    frames_.add(static_cast<std::size_t>(got));
    read_frames();
  }
}

void ViewServer::Parts::Connection::keep_time() {
  if (has_ended() || parts_.clock.now_ns() < due_ns()) {
    return;
  }
  if (phase_ == Phase::kOpen && !std::exchange(asked_, true)) {
    put(FrameOpcode::kPing, "");
  } else {
    end();
  }
}

void ViewServer::Parts::Connection::write() {
  while (!has_ended() && (sent_ < leaving_.size() || next())) {
    const ssize_t went = ::send(descriptor_, leaving_.data() + sent_,
                                leaving_.size() - sent_, MSG_NOSIGNAL);
    if (went >= 0) {
      sent_ += static_cast<std::size_t>(went);
    } else if (errno == EAGAIN) {
      return;
    } else if (errno != EINTR) {
      end();
    }
  }
}

bool ViewServer::Parts::Connection::next() {
  leaving_.clear();
  sent_ = 0;
  if (phase_ == Phase::kAnswer) {
    phase_ = goes_on_ ? Phase::kHead : Phase::kEnded;
    deadline_ns_ = parts_.clock.now_ns() + kRequestNs;
    read_request();
  } else if (phase_ == Phase::kClosing) {
    ::shutdown(descriptor_, SHUT_WR);
    phase_ = Phase::kClosed;
  } else if (pong_) {
    put(FrameOpcode::kPong, *std::exchange(pong_, std::nullopt));
  } else if (!waiting_.empty()) {
    put(FrameOpcode::kText, waiting_.front());
    waiting_.pop_front();
  } else if (latest_) {
    put(FrameOpcode::kText, *std::exchange(latest_, nullptr));
  }
  return !leaving_.empty();
}

void ViewServer::Parts::Connection::read_request() {
  const auto head = take_http_head(head_);
  if (has_ended() || (!head && head_.size() <= kHeaderBytes)) {
    return;  // more will come
  }
  const auto request =
      head && head->size() <= kHeaderBytes ? parse_http_request(*head) : std::nullopt;
  if (!request) {
    end();
  } else if (parts_.may_upgrade(*request)) {
    upgrade(*request);
  } else {
    leaving_ = parts_.answer(*request);
    goes_on_ = request->goes_on;
    phase_ = Phase::kAnswer;
  }
}

void ViewServer::Parts::Connection::upgrade(const HttpRequest& request) {
  leaving_ =
      "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: "
      "Upgrade\r\nSec-WebSocket-Accept: " +
      websocket_accept(std::string(request.only("sec-websocket-key"))) +
      "\r\nSec-WebSocket-Protocol: " + std::string(kViewProtocol) + "\r\n\r\n";
  phase_ = Phase::kOpen;
  deadline_ns_ = parts_.clock.now_ns() + kIdleNs;
  client_ = ++parts_.last;
  std::copy(head_.begin(), head_.end(), frames_.room().begin());
  frames_.add(head_.size());
  head_.clear();
  parts_.application.opened(client_);
  read_frames();
}

void ViewServer::Parts::Connection::read_frames() {
  while (phase_ == Phase::kOpen) {
    const auto now = std::chrono::steady_clock::now();
    switch (frames_.read()) {
      case FrameRead::kMessage:
        // Too many messages or control frames close the connection, with code 1008.
        if (rate_.allow(now)) {
          parts_.application.received(client_, frames_.payload());
        } else {
          drop(CloseCode::kPolicy);
        }
        break;
      case FrameRead::kPing:
        pong_ = frames_.payload();
        [[fallthrough]];
      case FrameRead::kPart:
        if (!control_rate_.allow(now)) {
          drop(CloseCode::kPolicy);
        }
        break;
      case FrameRead::kClose:
        close(frames_.payload());
        break;
      case FrameRead::kIncomplete:
        return;
      case FrameRead::kInvalid:
        drop(frames_.failure_code());
        break;
    }
    write();
  }
}

void ViewServer::Parts::Connection::send(std::string text) {
  if (phase_ != Phase::kOpen) {
    return;
  }
  if (waiting_.size() >= kWaitingMax) {
    drop(CloseCode::kTryAgainLater);
    return;
  }
  waiting_.push_back(std::move(text));
  write();
}

void ViewServer::Parts::Connection::send_latest(
    const std::shared_ptr<const std::string>& text) {
  if (phase_ == Phase::kOpen) {
    latest_ = text;
    write();
  }
}

void ViewServer::Parts::Connection::put(FrameOpcode opcode, std::string_view payload) {
  const std::size_t before = leaving_.size();
  leaving_.resize(before + payload.size() + kFrameHeaderBytes);
  leaving_.resize(before + write_frame(std::span(leaving_).subspan(before), opcode,
                                       true, payload, nullptr));
}

void ViewServer::Parts::Connection::close(std::string_view payload) {
  put(FrameOpcode::kClose, payload);
  phase_ = Phase::kClosing;
  deadline_ns_ = parts_.clock.now_ns() + kRequestNs;
  pong_.reset();
  waiting_.clear();
  latest_.reset();
}

void ViewServer::Parts::Connection::drop(CloseCode why) {
  const auto code = static_cast<std::uint16_t>(why);
  const std::array<char, 2> payload{static_cast<char>(code >> 8U),
                                    static_cast<char>(code & 0xFFU)};
  close({payload.data(), payload.size()});
}

}  // namespace palpate
