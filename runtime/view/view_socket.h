// The insides of the live view's server, for view_server.cc alone: nobody else needs to
// see Boost.Beast.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <list>
#include <map>
#include <optional>
#include <utility>  // before asio, which forgets it

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <fmt/format.h>

#include "runtime/view/view_message.h"
#include "runtime/view/view_policy.h"
#include "runtime/view/view_server.h"

namespace palpate {

namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = boost::asio::ip::tcp;
// With the executor of a context: a type-erased one takes longer to compile.
using Executor = boost::asio::io_context::executor_type;
using TcpSocket = boost::asio::basic_stream_socket<tcp, Executor>;
using TcpStream = beast::basic_stream<tcp, Executor>;
using Failure = beast::error_code;
using Request = http::request<http::empty_body>;
using Response = http::response<http::string_body>;
using SocketClock = std::chrono::steady_clock;
using SocketTimer =
    boost::asio::basic_waitable_timer<SocketClock,
                                      boost::asio::wait_traits<SocketClock>, Executor>;

inline constexpr std::size_t kHeaderBytes = 8192;
inline constexpr std::size_t kWaitingMax = 64;      // messages for one client
inline constexpr std::size_t kConnectionsMax = 32;  // of any kind
inline constexpr auto kRequestTime = std::chrono::seconds(10);
inline constexpr auto kControlFramesPerS = 20.0;  // pings and pongs of one client

inline std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}

inline beast::string_view view(std::string_view text) {
  return {text.data(), text.size()};
}

// What a request names; null if it is none of these.
template <typename Item>
const Item* at_path(const std::vector<Item>& items, const Request& request) {
  const auto found = std::find_if(items.begin(), items.end(), [&](const Item& one) {
    return one.path == view(request.target());
  });
  return found == items.end() ? nullptr : &*found;
}

// Shared by the connections; lives longer than any of them.
struct ViewServer::Parts {
  class Connection;
  class Socket;

  Parts(ViewServerOptions wanted, ViewApplication& app)
      : options(std::move(wanted)), application(app), acceptor(io), timer(io) {}

  void listen();
  void accept();
  void schedule(const std::atomic<bool>& stop);
  [[nodiscard]] std::optional<http::status> refusal(const Request& request) const;
  [[nodiscard]] Response answer(const Request& request) const;
  [[nodiscard]] bool may_upgrade(const Request& request) const;
  /// Closes the connection that has said nothing for longest; false where all speak.
  bool close_idlest();
  /// Null for a client that has gone.
  [[nodiscard]] std::shared_ptr<Socket> socket(ViewClient client) const {
    const auto found = sockets.find(client);
    return found == sockets.end() ? nullptr : found->second.lock();
  }

  ViewServerOptions options;
  ViewApplication& application;
  std::string host;    // "127.0.0.1:8080"
  std::string policy;  // Content-Security-Policy
  std::map<ViewClient, std::weak_ptr<Socket>> sockets;
  ViewClient last = 0;
  std::size_t connections = 0;
  std::list<Connection*> silent;  ///< that wait for a request, oldest first
  boost::asio::io_context io{1};  // after what its connections touch when they end
  boost::asio::basic_socket_acceptor<tcp, Executor> acceptor;
  SocketTimer timer;
};

// One WebSocket, from its handshake to its end.
class ViewServer::Parts::Socket : public std::enable_shared_from_this<Socket> {
 public:
  Socket(Parts& parts, TcpStream stream, ViewClient client)
      : parts_(parts),
        stream_(std::move(stream)),
        client_(client),
        rate_(parts.options.messages_per_s_max),
        control_rate_(kControlFramesPerS) {}
  ~Socket() { --parts_.connections; }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  void start(const Request& request) {
    websocket::stream_base::timeout times{};
    times.handshake_timeout = kRequestTime;
    times.idle_timeout = std::chrono::seconds(20);
    times.keep_alive_pings = true;
    beast::get_lowest_layer(stream_).expires_never();
    stream_.set_option(times);
    stream_.set_option(websocket::stream_base::decorator([](auto& response) {
      response.set(http::field::sec_websocket_protocol, view(kViewProtocol));
    }));
    stream_.read_message_max(kViewMessageBytes);
    stream_.control_callback([this](websocket::frame_type, beast::string_view) {
      // Frames that are no messages cost time, too. Beast answers this one yet.
      if (!control_rate_.allow(SocketClock::now()) && !closing_) {
        drop(websocket::close_code::policy_error);
      }
    });
    stream_.text(true);
    stream_.async_accept(request, [self = shared_from_this()](Failure failure) {
      if (failure) {
        self->end();
        return;
      }
      self->open_ = true;
      self->parts_.application.opened(self->client_);
      self->read();
    });
  }

  void send(std::string text) {
    if (waiting_.size() >= kWaitingMax) {
      drop(websocket::close_code::try_again_later);
      return;
    }
    waiting_.push_back(std::make_shared<const std::string>(std::move(text)));
    write();
  }

  void send_latest(const std::shared_ptr<const std::string>& text) {
    latest_ = text;
    write();
  }

 private:
  void read() {
    stream_.async_read(buffer_,
                       [self = shared_from_this()](Failure failure, std::size_t) {
                         if (failure) {
                           self->end();
                           return;
                         }
                         if (!self->closing_) {
                           self->take();
                         }
                         if (!self->closing_) {
                           self->read();
                         }  // else the close reads on: closing unread input at once
                            // would take the reason from the client
                       });
  }

  void take() {
    const bool allowed = rate_.allow(SocketClock::now()) && stream_.got_text();
    const std::string text = beast::buffers_to_string(buffer_.data());
    buffer_.consume(buffer_.size());
    if (!allowed) {
      drop(websocket::close_code::policy_error);
      return;
    }
    parts_.application.received(client_, text);
  }

  void write() {
    if (writing_ != nullptr || closing_ || !open_) {
      return;
    }
    if (!waiting_.empty()) {
      writing_ = waiting_.front();
      waiting_.pop_front();
    } else {
      writing_ = std::exchange(latest_, nullptr);
    }
    if (writing_ == nullptr) {
      return;
    }
    stream_.async_write(boost::asio::buffer(*writing_),
                        [self = shared_from_this()](Failure failure, std::size_t) {
                          self->writing_ = nullptr;
                          if (failure) {
                            self->end();
                          } else {
                            self->write();
                          }
                        });
  }

  void drop(websocket::close_code why) {
    if (std::exchange(closing_, true)) {
      return;
    }
    stream_.async_close(why, [self = shared_from_this()](Failure) {
      self->end();
    });
  }

  void end() {
    if (std::exchange(open_, false)) {
      parts_.application.closed(client_);
    }
    parts_.sockets.erase(client_);
    Failure ignored;
    beast::get_lowest_layer(stream_).socket().close(ignored);
  }

  Parts& parts_;
  websocket::stream<TcpStream, false> stream_;
  beast::flat_buffer buffer_{kViewMessageBytes};
  ViewClient client_;
  MessageRate rate_;
  MessageRate control_rate_;
  std::deque<std::shared_ptr<const std::string>> waiting_;
  std::shared_ptr<const std::string> latest_;
  std::shared_ptr<const std::string> writing_;
  bool open_ = false;
  bool closing_ = false;
};

}  // namespace palpate
