// The insides of the live view's server: who is served what in view_server.cc, its
// connections in view_connection.cc.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <poll.h>

#include "runtime/inverse/websocket_frame.h"
#include "runtime/realtime/clock.h"
#include "runtime/view/view_message.h"
#include "runtime/view/view_policy.h"
#include "runtime/view/view_request.h"
#include "runtime/view/view_server.h"

namespace palpate {

inline constexpr std::size_t kHeaderBytes = 8192;
inline constexpr std::size_t kWaitingMax = 64;      // messages for one client
inline constexpr std::size_t kConnectionsMax = 32;  // of any kind
inline constexpr std::int64_t kRequestNs = 10 * kSecondNs;
inline constexpr std::int64_t kIdleNs = 20 * kSecondNs;  // of a client
inline constexpr double kControlFramesPerS = 20.0;       // of one client, and parts

// Shared by the connections; lives longer than any of them.
struct ViewServer::Parts {
  class Connection;

  Parts(ViewServerOptions wanted, ViewApplication& app);
  ~Parts();
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  void listen();
  // Waits for the network until something is due.
  void serve_until(std::int64_t due_ns);
  // A connection that speaks HTTP has to go where there is no place for another.
  void accept();
  // Takes away who has ended.
  void sweep();
  [[nodiscard]] bool may_upgrade(const HttpRequest& request) const;
  // The whole of it, as sent.
  [[nodiscard]] std::string answer(const HttpRequest& request) const;
  [[nodiscard]] std::size_t clients() const;
  // Null for one that has gone.
  [[nodiscard]] Connection* connection(ViewClient client) const;

  ViewServerOptions options;
  ViewApplication& application;
  MonotonicClock clock;
  std::string host{};    // "127.0.0.1:8080"
  std::string policy{};  // Content-Security-Policy
  int acceptor = -1;
  ViewClient last = 0;
  std::vector<std::unique_ptr<Connection>> connections{};
};

// One TCP connection: requests by HTTP, and then perhaps a WebSocket until its end.
class ViewServer::Parts::Connection {
 public:
  // @param descriptor never waits; the connection's from here on.
  Connection(Parts& parts, int descriptor);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  [[nodiscard]] ViewClient client() const { return client_; }  // 0: none
  [[nodiscard]] bool has_ended() const { return phase_ == Phase::kEnded; }
  void end() { phase_ = Phase::kEnded; }
  [[nodiscard]] pollfd waits_for() const;
  // When it ends, or is asked whether it still lives, if nothing happens.
  [[nodiscard]] std::int64_t due_ns() const;

  // Takes what has come, if anything has; sends what can leave.
  void serve(bool came);
  void send(std::string text);
  void send_latest(const std::shared_ptr<const std::string>& text);

 private:
  enum class Phase : std::uint8_t {
    kHead,     // of a request
    kAnswer,   // leaves
    kOpen,     // messages both ways
    kClosing,  // what is left leaves
    kClosed,   // what comes is read, for who closes with bytes unread takes the reason
               // from the client
    kEnded,
  };

  void read();
  void write();
  void keep_time();
  // The next of what is to leave; false if there is nothing.
  bool next();
  void read_request();
  void upgrade(const HttpRequest& request);
  void read_frames();
  void put(FrameOpcode opcode, std::string_view payload);
  void close(std::string_view payload);
  void drop(CloseCode why);

  Parts& parts_;
  int descriptor_;
  ViewClient client_ = 0;
  Phase phase_ = Phase::kHead;
  std::int64_t deadline_ns_;  // ends then
  bool asked_ = false;        // whether the client still lives
  std::string head_{};
  bool goes_on_ = false;
  WebsocketReader frames_{true, kViewMessageBytes};
  MessageRate rate_;
  MessageRate control_rate_{kControlFramesPerS};
  std::optional<std::string> pong_{};
  std::deque<std::string> waiting_{};
  std::shared_ptr<const std::string> latest_{};
  std::string leaving_{};  // whole frames, of which sent_ bytes have left
  std::size_t sent_ = 0;
};

}  // namespace palpate
