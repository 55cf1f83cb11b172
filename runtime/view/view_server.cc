#include "runtime/view/view_server.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "runtime/view/view_socket.h"

namespace palpate {
namespace {

// Beast's own writing of responses takes some seconds more to compile.
std::string as_sent(const Response& response) {
  std::string text = fmt::format("HTTP/1.{} {} {}\r\n", response.version() % 10,
                                 response.result_int(), view(response.reason()));
  for (const auto& field : response) {
    text += fmt::format("{}: {}\r\n", view(field.name_string()), view(field.value()));
  }
  return text + "\r\n" + response.body();
}

}  // namespace

// One TCP connection as long as it speaks HTTP.
class ViewServer::Parts::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Parts& parts, TcpSocket socket)
      : parts_(parts), stream_(std::move(socket)) {
    ++parts_.connections;
  }
  ~Connection() {
    be_heard();
    parts_.connections -= handed_over_ ? 0 : 1;
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void read() {
    parser_.emplace();
    parser_->header_limit(kHeaderBytes);
    parser_->body_limit(0);
    stream_.expires_after(kRequestTime);
    parts_.silent.push_back(this);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](Failure failure, std::size_t) {
                       self->be_heard();
                       if (!failure) {
                         self->serve();
                       }  // else gone, too slow or no HTTP: the stream closes
                     });
  }

  // Another connection needs its place.
  void close() {
    Failure ignored;
    stream_.socket().close(ignored);
  }

 private:
  void be_heard() { parts_.silent.remove(this); }

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
    const Response response = parts_.answer(request);
    leaving_ = as_sent(response);
    boost::asio::async_write(
        stream_, boost::asio::buffer(leaving_),
        [self = shared_from_this(), goes_on = response.keep_alive()](Failure failure,
                                                                     std::size_t) {
          if (!failure && goes_on) {
            self->read();
          }
        });
  }

  Parts& parts_;
  TcpStream stream_;
  beast::flat_buffer buffer_{kHeaderBytes + 1024};
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::string leaving_;
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
    acceptor.set_option(boost::asio::socket_base::reuse_address(true), failure);
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
  acceptor.async_accept([this](Failure failure, TcpSocket socket) {
    if (!acceptor.is_open()) {
      return;
    }
    // Connections that say nothing must not keep the page's own requests out.
    if (!failure && (connections < kConnectionsMax || close_idlest())) {
      Failure ignored;
      socket.set_option(tcp::no_delay(true), ignored);
      std::make_shared<Connection>(*this, std::move(socket))->read();
    }
    accept();
  });
}

bool ViewServer::Parts::close_idlest() {
  if (silent.empty()) {
    return false;
  }
  Connection* const idlest = silent.front();
  silent.pop_front();
  idlest->close();  // its read ends with a failure, and with it the connection
  return true;
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
  if (const auto refused = refusal(request)) {
    response.result(*refused);
  } else if (const auto* asset = at_path(options.assets, request)) {
    response.result(http::status::ok);
    response.set(http::field::content_type, view(asset->content_type));
    response.body() = asset->bytes;
  } else if (const auto* data = at_path(options.data, request)) {
    const bool known = same_token(view(request[http::field::authorization]),
                                  "Bearer " + options.token);
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
                    "{} digits, must have 32",
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
  if (const auto socket = parts_->socket(client)) {
    socket->send(std::move(text));
  }
}

void ViewServer::send_latest(ViewClient client,
                             const std::shared_ptr<const std::string>& text) {
  if (const auto socket = parts_->socket(client)) {
    socket->send_latest(text);
  }
}

}  // namespace palpate
