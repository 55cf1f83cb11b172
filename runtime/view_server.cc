// Longer than most files: Beast, slow to compile, is seen by this one alone.
#include "runtime/view_server.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <utility>  // before asio, which forgets it

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <fmt/format.h>

#include "formats/error.h"
#include "runtime/view_message.h"
#include "runtime/view_policy.h"

namespace palpate {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = boost::asio::ip::tcp;
using Failure = beast::error_code;
using Request = http::request<http::empty_body>;
using Response = http::response<http::string_body>;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kHeaderBytes = 8192;
constexpr std::size_t kWaitingMax = 64;      // messages for one client
constexpr std::size_t kConnectionsMax = 32;  // of any kind
constexpr auto kRequestTime = std::chrono::seconds(10);

std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}

beast::string_view view(std::string_view text) {
  return {text.data(), text.size()};
}

}  // namespace

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

  ViewServerOptions options;
  ViewApplication& application;
  std::string host;    // "127.0.0.1:8080"
  std::string policy;  // Content-Security-Policy
  std::map<ViewClient, std::weak_ptr<Socket>> sockets;
  ViewClient last = 0;
  std::size_t connections = 0;
  boost::asio::io_context io{1};  // after what its connections touch when they end
  tcp::acceptor acceptor;
  boost::asio::steady_timer timer;
};

// One WebSocket, from its handshake to its end.
class ViewServer::Parts::Socket : public std::enable_shared_from_this<Socket> {
 public:
  Socket(Parts& parts, beast::tcp_stream stream, ViewClient client)
      : parts_(parts),
        stream_(std::move(stream)),
        client_(client),
        rate_(parts.options.messages_per_s_max) {}
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
                         if (failure || self->closing_) {
                           self->end();
                           return;
                         }
                         self->take();
                         self->read();
                       });
  }

  void take() {
    const bool allowed = rate_.allow(Clock::now()) && stream_.got_text();
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

  // The close waits for nothing but a write that is under way.
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
  websocket::stream<beast::tcp_stream, false> stream_;
  beast::flat_buffer buffer_{kViewMessageBytes};
  ViewClient client_;
  MessageRate rate_;
  std::deque<std::shared_ptr<const std::string>> waiting_;
  std::shared_ptr<const std::string> latest_;
  std::shared_ptr<const std::string> writing_;
  bool open_ = false;
  bool closing_ = false;
};

// One TCP connection as long as it speaks HTTP.
class ViewServer::Parts::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Parts& parts, tcp::socket socket)
      : parts_(parts), stream_(std::move(socket)) {
    ++parts_.connections;
  }
  ~Connection() { parts_.connections -= handed_over_ ? 0 : 1; }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void read() {
    parser_.emplace();
    parser_->header_limit(kHeaderBytes);
    parser_->body_limit(0);
    stream_.expires_after(kRequestTime);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](Failure failure, std::size_t) {
                       if (!failure) {
                         self->serve();
                       }  // else gone, too slow or no HTTP: the stream closes
                     });
  }

 private:
  void serve() {
    const Request request = parser_->release();
    if (websocket::is_upgrade(request) && parts_.may_upgrade(request)) {
      const ViewClient client = ++parts_.last;
      auto socket = std::make_shared<Socket>(parts_, std::move(stream_), client);
      handed_over_ = true;
      parts_.sockets[client] = socket;
      socket->start(request);
      return;
    }
    response_ = parts_.answer(request);
    http::async_write(stream_, response_,
                      [self = shared_from_this()](Failure failure, std::size_t) {
                        if (!failure && self->response_.keep_alive()) {
                          self->read();
                        }
                      });
  }

  Parts& parts_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{kHeaderBytes + 1024};
  std::optional<http::request_parser<http::empty_body>> parser_;
  Response response_;
  bool handed_over_ = false;
};

void ViewServer::Parts::listen() {
  const tcp::endpoint endpoint(boost::asio::ip::address_v4::loopback(), options.port);
  Failure failure;
  acceptor.open(endpoint.protocol(), failure);
  const auto in_order = [&failure](auto&& call) {
    if (!failure) {
      call();
    }
  };
  in_order([&] {
    acceptor.set_option(tcp::acceptor::reuse_address(true), failure);
  });
  in_order([&] {
    acceptor.bind(endpoint, failure);
  });
  in_order([&] {
    acceptor.listen(8, failure);
  });
  if (failure) {
    throw InputError(fmt::format("cannot listen on 127.0.0.1:{}: {}", options.port,
                                 failure.message()));
  }
  host = fmt::format("127.0.0.1:{}", acceptor.local_endpoint().port());
  policy = content_policy(host);
}

void ViewServer::Parts::accept() {
  acceptor.async_accept([this](Failure failure, tcp::socket socket) {
    if (!acceptor.is_open()) {
      return;
    }
    if (!failure && connections < kConnectionsMax) {
      Failure ignored;
      socket.set_option(tcp::no_delay(true), ignored);
      std::make_shared<Connection>(*this, std::move(socket))->read();
    }
    accept();
  });
}

void ViewServer::Parts::schedule(const std::atomic<bool>& stop) {
  timer.expires_after(std::chrono::nanoseconds(std::llround(1e9 / options.frame_hz)));
  timer.async_wait([this, &stop](Failure) {
    if (stop.load()) {
      io.stop();
      return;
    }
    application.frame();
    schedule(stop);
  });
}

// Why a request is not served at all, before anybody looks at its path.
std::optional<http::status> ViewServer::Parts::refusal(const Request& request) const {
  if (request.count(http::field::host) != 1 ||
      request[http::field::host] != beast::string_view(host)) {
    return http::status::misdirected_request;
  }
  if (request.method() != http::verb::get && request.method() != http::verb::head) {
    return http::status::method_not_allowed;
  }
  if (websocket::is_upgrade(request)) {
    return http::status::forbidden;  // may_upgrade() has said no
  }
  return std::nullopt;
}

bool ViewServer::Parts::may_upgrade(const Request& request) const {
  return request.count(http::field::host) == 1 &&
         request[http::field::host] == beast::string_view(host) &&
         request.count(http::field::origin) == 1 &&
         view(request[http::field::origin]) == "http://" + host &&
         view(request.target()) == "/live" && sockets.size() < options.clients_max &&
         brings_token(view(request[http::field::sec_websocket_protocol]),
                      options.token);
}

Response ViewServer::Parts::answer(const Request& request) const {
  Response response(http::status::not_found, request.version());
  response.keep_alive(request.keep_alive());
  response.set(http::field::content_type, "text/plain; charset=utf-8");
  response.set(http::field::cache_control, "no-store");
  response.set("Content-Security-Policy", policy);
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  response.set("Cross-Origin-Opener-Policy", "same-origin");
  const std::string_view path = view(request.target());
  if (const auto refused = refusal(request)) {
    response.result(*refused);
  } else if (const auto asset =
                 std::find_if(options.assets.begin(), options.assets.end(),
                              [&](const ViewAsset& one) {
                                return one.path == path;
                              });
             asset != options.assets.end()) {
    response.result(http::status::ok);
    response.set(http::field::content_type, view(asset->content_type));
    response.body() = asset->bytes;
  } else if (const auto data = std::find_if(options.data.begin(), options.data.end(),
                                            [&](const ViewData& one) {
                                              return one.path == path;
                                            });
             data != options.data.end()) {
    const std::string wanted = "Bearer " + options.token;
    const bool known = same_token(view(request[http::field::authorization]), wanted);
    response.result(known ? http::status::ok : http::status::forbidden);
    response.set(http::field::content_type, data->content_type);
    response.body() = known ? data->bytes : "";
  }
  response.content_length(response.body().size());
  if (request.method() == http::verb::head) {
    response.body().clear();
  }
  return response;
}

ViewServer::ViewServer(ViewServerOptions options, ViewApplication& application)
    : parts_(std::make_unique<Parts>(std::move(options), application)) {
  const ViewServerOptions& o = parts_->options;
  if (o.token.size() != 32 || !(o.frame_hz > 0.0 && o.frame_hz <= 1000.0)) {
    throw InputError(
        fmt::format("live view: frame rate is {} Hz, must lie in (0, 1000], token of "
                    "{} digits, must "
                    "have 32",
                    o.frame_hz, o.token.size()));
  }
  parts_->listen();
}

ViewServer::~ViewServer() = default;

std::uint16_t ViewServer::port() const {
  return parts_->acceptor.local_endpoint().port();
}

std::string ViewServer::address() const {
  return fmt::format("http://{}/#{}", parts_->host, parts_->options.token);
}

void ViewServer::run(const std::atomic<bool>& stop) {
  parts_->accept();
  parts_->schedule(stop);
  parts_->io.run();
}

void ViewServer::send(ViewClient client, std::string text) {
  const auto found = parts_->sockets.find(client);
  if (const auto socket =
          found != parts_->sockets.end() ? found->second.lock() : nullptr) {
    socket->send(std::move(text));
  }
}

void ViewServer::send_latest(ViewClient client,
                             const std::shared_ptr<const std::string>& text) {
  const auto found = parts_->sockets.find(client);
  if (const auto socket =
          found != parts_->sockets.end() ? found->second.lock() : nullptr) {
    socket->send_latest(text);
  }
}

}  // namespace palpate
