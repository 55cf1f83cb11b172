// The insides of the emulated Inverse service, for emulated_inverse.cc alone: nobody
// else needs to see Boost.Beast.
#pragma once

#include <chrono>
#include <deque>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <nlohmann/json.hpp>

#include "runtime/inverse/emulated_inverse.h"
#include "runtime/inverse/inverse_message.h"
#include "runtime/realtime/clock.h"

namespace palpate {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using Failure = beast::error_code;
using Json = nlohmann::json;

// All but the accessors' reading happens in the service's thread.
struct EmulatedInverse::Parts {
  class Session;

  explicit Parts(const EmulatedInverseConfig& wanted)
      : config(wanted),
        tool(config.dynamics, config.hand, clock, {.position_m = config.start_m}),
        states(io),
        events(io),
        idle(io) {
    key = force_key(inverse_version(config.version).value_or(InverseVersion{3, 5}));
    key = key == nullptr ? "values" : key;
    tool.open();
  }

  void listen(tcp::acceptor& acceptor, std::uint16_t port);
  void accept(tcp::acceptor& acceptor, bool of_events);
  [[nodiscard]] bool is_faulty(InverseFault fault) const {
    const InverseFaults& f = config.faults;
    return f.fault == fault && message >= f.from &&
           (f.count < 0 || message < f.from + f.count);
  }
  [[nodiscard]] std::string first_message();
  [[nodiscard]] Json state(bool whole);
  [[nodiscard]] Json grips();
  void obey(const std::string& text);
  void push(const Eigen::Vector3d& force_n);
  void release() {
    const std::lock_guard lock(mutex);
    push(Eigen::Vector3d::Zero());
  }
  [[nodiscard]] std::string answer() {
    const std::lock_guard lock(mutex);
    return state(false).dump();
  }
  void tell(const std::string& event);

  EmulatedInverseConfig config;
  MonotonicClock clock;
  SimulatedDevice tool;
  mutable std::mutex mutex;  // what follows, and the tool
  std::int64_t message = 0;
  std::int64_t first_ns = 0;  // of messages
  std::int64_t released_ns = 0;
  std::string profile;
  std::string refused;
  std::vector<MotorRecord> trace;
  const char* key = nullptr;
  bool told = false;
  std::set<std::shared_ptr<Session>> listeners;  // of events
  asio::io_context io{1};
  tcp::acceptor states;
  tcp::acceptor events;
  asio::steady_timer idle;
  std::thread thread;
};

// One connection: a request for the version, or a WebSocket.
class EmulatedInverse::Parts::Session : public std::enable_shared_from_this<Session> {
 public:
  Session(Parts& parts, tcp::socket socket, bool of_events)
      : parts_(parts),
        stream_(std::move(socket)),
        timer_(parts.io),
        of_events_(of_events) {}

  void start() {
    http::async_read(stream_.next_layer(), buffer_, request_,
                     [self = shared_from_this()](Failure failure, std::size_t) {
                       if (!failure) {
                         self->serve();
                       }
                     });
  }

  // Leaves after everything before it, no earlier than due.
  void send(std::string text, std::int64_t delay_ns = 0) {
    waiting_.emplace_back(
        std::chrono::steady_clock::now() + std::chrono::nanoseconds(delay_ns),
        std::move(text));
    write();
  }

 private:
  void serve() {
    if (websocket::is_upgrade(request_)) {
      stream_.async_accept(request_, [self = shared_from_this()](Failure failure) {
        if (!failure) {
          self->opened();
        }
      });
      return;
    }
    response_.result(request_.target() == "/version" ? http::status::ok
                                                     : http::status::not_found);
    response_.body() = Json{{"version", parts_.config.version}}.dump();
    response_.prepare_payload();
    response_.keep_alive(false);
    http::async_write(stream_.next_layer(), response_,
                      [self = shared_from_this()](Failure, std::size_t) {
                        self->cut();
                      });
  }

  void opened() {
    open_ = true;
    stream_.text(true);
    if (of_events_) {
      parts_.listeners.insert(shared_from_this());
    } else {
      send(parts_.first_message());
    }
    read();
  }

  void read() {
    stream_.async_read(
        buffer_, [self = shared_from_this()](Failure failure, std::size_t) {
          if (failure) {
            self->end();
            return;
          }
          const std::string text = beast::buffers_to_string(self->buffer_.data());
          self->buffer_.consume(self->buffer_.size());
          if (!self->of_events_) {
            self->take(text);
          }
          if (self->open_) {
            self->read();
          }
        });
  }

  void take(const std::string& text) {
    parts_.obey(text);
    const InverseFaults& faults = parts_.config.faults;
    const auto is = [this](InverseFault fault) {
      return parts_.is_faulty(fault);
    };
    if (is(InverseFault::kClosed)) {
      stream_.async_close(websocket::close_code::going_away,
                          [self = shared_from_this()](Failure) {
                            self->end();
                          });
      open_ = false;
      parts_.release();
    } else if (is(InverseFault::kCutFrame)) {
      Failure ignored;
      const std::string half = "\x81\x7E\x04\x01{\"inverse3\":[{\"dev";
      stream_.next_layer().write_some(asio::buffer(half), ignored);
      end();
    } else if (!is(InverseFault::kMissing)) {
      const std::string answer =
          is(InverseFault::kText) ? faults.text : parts_.answer();
      for (int i = is(InverseFault::kUnasked) ? 100 : 1; i > 0; --i) {
        send(answer, is(InverseFault::kLate) ? faults.late_ns : 0);
      }
    }
  }

  void write() {
    if (writing_ || waiting_.empty() || !open_) {
      return;
    }
    writing_ = true;
    timer_.expires_at(waiting_.front().first);
    if (waiting_.front().first <= std::chrono::steady_clock::now()) {
      write_front();
      return;
    }
    timer_.async_wait([self = shared_from_this()](Failure) {
      self->write_front();
    });
  }

  void write_front() {
    leaving_ = std::move(waiting_.front().second);
    waiting_.pop_front();
    stream_.async_write(asio::buffer(leaving_),
                        [self = shared_from_this()](Failure failure, std::size_t) {
                          self->writing_ = false;
                          if (failure) {
                            self->end();
                          } else {
                            self->write();
                          }
                        });
  }

  void cut() {
    Failure ignored;
    stream_.next_layer().shutdown(tcp::socket::shutdown_both, ignored);
    stream_.next_layer().close(ignored);
  }

  // The session's forces end with it.
  void end() {
    open_ = false;
    timer_.cancel();
    parts_.listeners.erase(shared_from_this());
    if (!of_events_) {
      parts_.release();
    }
    cut();
  }

  Parts& parts_;
  websocket::stream<tcp::socket> stream_;
  asio::steady_timer timer_;
  beast::flat_buffer buffer_;
  http::request<http::string_body> request_;
  http::response<http::string_body> response_;
  std::deque<std::pair<std::chrono::steady_clock::time_point, std::string>> waiting_;
  std::string leaving_;
  bool writing_ = false;
  bool open_ = false;
  bool of_events_;
};

}  // namespace palpate
