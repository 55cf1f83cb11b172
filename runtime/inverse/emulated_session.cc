// Connections to the emulated Inverse service: one thread waits for all of them.
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "runtime/inverse/emulated_inverse_parts.h"
#include "runtime/inverse/service_connection.h"
#include "runtime/inverse/websocket_frame.h"
#include "runtime/inverse/websocket_handshake.h"

namespace palpate {
namespace {

constexpr std::size_t kPieceBytes = 4096;  // of a message in one frame

// @param port the one that was had, if any was wanted.
int listening(std::uint16_t& port) {
  const int descriptor = listen_on_loopback(port);
  if (descriptor < 0) {
    throw DeviceError(fmt::format("emulated Inverse service: port {}: {}", port,
                                  std::strerror(errno)));
  }
  return descriptor;
}

}  // namespace

// One connection: a request for the version, or a WebSocket.
class EmulatedInverse::Parts::Session {
 public:
  // @param descriptor never waits; the session's from here on.
  Session(Parts& parts, int descriptor, bool of_events)
      : parts_(parts), descriptor_(descriptor), of_events_(of_events) {}
  ~Session() { ::close(descriptor_); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  [[nodiscard]] bool of_events() const { return of_events_; }
  [[nodiscard]] bool commands() const { return opened_ && !of_events_; }
  [[nodiscard]] bool has_ended() const { return phase_ == Phase::kEnded; }
  [[nodiscard]] pollfd waits_for() const {
    const int more = leaving_.empty() ? 0 : POLLOUT;
    return {descriptor_, static_cast<short>(POLLIN | more), 0};
  }

  // When write() has something to do, if nothing else happens.
  [[nodiscard]] std::int64_t due_ns() const {
    return phase_ == Phase::kOpen && !waiting_.empty() ? waiting_.front().first
                                                       : InverseEmulation::kNever;
  }

  // Takes what has come.
  void read() {
    const std::span<char> room = frames_.room();
    const ssize_t got = ::recv(descriptor_, room.data(), room.size(), 0);
    if (got <= 0) {
      phase_ = got < 0 && (errno == EAGAIN || errno == EINTR) ? phase_ : Phase::kEnded;
      return;
    }
    if (phase_ == Phase::kHead) {
      head_.append(room.data(), static_cast<std::size_t>(got));
      serve();
    } else {
      frames_.add(static_cast<std::size_t>(got));
    }
    take_frames();
  }

  // Leaves after everything before it, no earlier than due.
  void send(std::string text, std::int64_t delay_ns = 0) {
    if (phase_ == Phase::kOpen) {
      waiting_.emplace_back(parts_.clock.now_ns() + delay_ns, std::move(text));
      write();
    }
  }

  void write() {
    const std::int64_t now_ns = parts_.clock.now_ns();
    for (; due_ns() <= now_ns; waiting_.pop_front()) {
      std::string_view rest = waiting_.front().second;
      FrameOpcode opcode = FrameOpcode::kText;
      do {
        const std::string_view piece = rest.substr(0, kPieceBytes);
        rest.remove_prefix(piece.size());
        put(opcode, rest.empty(), piece);
        opcode = FrameOpcode::kContinuation;
      } while (!rest.empty());
    }
    while (!leaving_.empty()) {
      const ssize_t went =
          ::send(descriptor_, leaving_.data(), leaving_.size(), MSG_NOSIGNAL);
      if (went >= 0) {
        leaving_.erase(0, static_cast<std::size_t>(went));
      } else if (errno == EAGAIN) {
        return;
      } else if (errno != EINTR) {
        phase_ = Phase::kEnded;
        return;
      }
    }
    phase_ = phase_ == Phase::kLast ? Phase::kEnded : phase_;
  }

 private:
  enum class Phase : std::uint8_t {
    kHead,     // of a request
    kOpen,     // messages both ways
    kClosing,  // the other end has to say that it closes, too
    kLast,     // ends when all is written
    kEnded,
  };

  void serve() {
    const auto request = take_http_head(head_);
    if (!request) {
      phase_ = head_.size() > kHttpHeadBytes ? Phase::kEnded : phase_;
      return;
    }
    const std::string key = http_field(*request, "sec-websocket-key");
    if (lower_case(http_field(*request, "upgrade")) != "websocket" || key.empty()) {
      const bool known = request->starts_with("GET /version HTTP/1.");
      const std::string body = parts_.service.version();
      leaving_ = fmt::format(
          "HTTP/1.1 {}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{}",
          known ? "200 OK" : "404 Not Found", body.size(), body);
      phase_ = Phase::kLast;
      return;
    }
    leaving_ =
        "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\n"
        "Connection: Upgrade\r\nSec-WebSocket-Accept: " +
        websocket_accept(key) + "\r\n\r\n";
    phase_ = Phase::kOpen;
    opened_ = true;
    std::copy(head_.begin(), head_.end(), frames_.room().begin());
    frames_.add(head_.size());
    if (!of_events_) {
      send(first_message());
    }
  }

  [[nodiscard]] std::string first_message() {
    const std::lock_guard lock(parts_.mutex);
    return parts_.service.first_message();
  }

  void take_frames() {
    while (phase_ == Phase::kOpen || phase_ == Phase::kClosing) {
      switch (frames_.read()) {
        case FrameRead::kMessage:
          if (phase_ == Phase::kOpen && !of_events_) {
            take(std::string(frames_.payload()));
          }
          break;
        case FrameRead::kPart:
          break;
        case FrameRead::kPing:
          put(FrameOpcode::kPong, true, frames_.payload());
          break;
        case FrameRead::kClose:
          if (phase_ == Phase::kOpen) {
            put(FrameOpcode::kClose, true, frames_.payload());
          }
          phase_ = Phase::kLast;
          break;
        case FrameRead::kIncomplete:
          return;
        case FrameRead::kInvalid:
          phase_ = Phase::kEnded;
          break;
      }
    }
  }

  void take(const std::string& text) {
    const std::lock_guard lock(parts_.mutex);
    InverseEmulation& service = parts_.service;
    service.obey(text);
    const InverseFaults& faults = parts_.config.faults;
    const auto is = [&service](InverseFault fault) {
      return service.is_faulty(fault);
    };
    if (is(InverseFault::kClosed)) {
      put(FrameOpcode::kClose, true, "\x03\xE9");  // 1001, going away
      phase_ = Phase::kClosing;
      service.release();
    } else if (is(InverseFault::kCutFrame)) {
      leaving_ += "\x81\x7E\x04\x01{\"inverse3\":[{\"dev";
      phase_ = Phase::kLast;
    } else if (!is(InverseFault::kMissing)) {
      const std::string answer =
          is(InverseFault::kText) ? faults.text : service.answer();
      for (int i = is(InverseFault::kUnasked) ? 100 : 1; i > 0; --i) {
        send(answer, is(InverseFault::kLate) ? faults.late_ns : 0);
      }
    }
  }

  void put(FrameOpcode opcode, bool last, std::string_view payload) {
    const std::size_t before = leaving_.size();
    leaving_.resize(before + payload.size() + kFrameHeaderBytes);
    leaving_.resize(before + write_frame(std::span(leaving_).subspan(before), opcode,
                                         last, payload, nullptr));
  }

  Parts& parts_;
  int descriptor_;
  bool of_events_;
  bool opened_ = false;
  Phase phase_ = Phase::kHead;
  std::string head_;
  WebsocketReader frames_{true};
  std::deque<std::pair<std::int64_t, std::string>> waiting_;  // due [ns], text
  std::string leaving_;
};

void EmulatedInverse::Parts::listen() {
  wake = ::eventfd(0, EFD_CLOEXEC);
  states = listening(config.port);
  events = listening(config.events_port);
}

EmulatedInverse::Parts::~Parts() {
  for (const int descriptor : {wake, states, events}) {
    ::close(descriptor);
  }
}

void EmulatedInverse::Parts::accept(const pollfd& acceptor) {
  const int descriptor = acceptor.revents == 0 ? -1 : accept_connection(acceptor.fd);
  if (descriptor >= 0) {
    sessions.push_back(
        std::make_shared<Session>(*this, descriptor, acceptor.fd == events));
  }
}

void EmulatedInverse::Parts::run() {
  std::vector<pollfd> ends;
  for (;;) {
    ends = {{wake, POLLIN, 0}, {states, POLLIN, 0}, {events, POLLIN, 0}};
    std::int64_t due_ns = service.idle_due_ns();
    for (const auto& session : sessions) {
      ends.push_back(session->waits_for());
      due_ns = std::min(due_ns, session->due_ns());
    }
    wait_for_sockets(ends, due_ns);
    if (ends[0].revents != 0) {
      return;
    }
    for (std::size_t i = 0; i < sessions.size(); ++i) {
      if (ends[3 + i].revents != 0) {
        sessions[i]->read();
      }
      sessions[i]->write();
    }
    if (service.idle_due_ns() <= clock.now_ns()) {
      release();
    }
    // The forces of a session end with it.
    std::erase_if(sessions, [this](const auto& session) {
      if (session->has_ended() && session->commands()) {
        release();
      }
      return session->has_ended();
    });
    accept(ends[1]);
    accept(ends[2]);
  }
}

void EmulatedInverse::Parts::tell(const std::string& event) {
  for (const auto& session : sessions) {
    if (session->of_events()) {
      session->send(event);
    }
  }
}

}  // namespace palpate
