#include "runtime/view/view_server.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "runtime/inverse/service_connection.h"
#include "runtime/view/view_server_parts.h"

namespace palpate {
namespace {

constexpr const char* kOk = "200 OK";
constexpr const char* kForbidden = "403 Forbidden";

// What a request names; null if it is none of these.
template <typename Item>
const Item* at_path(const std::vector<Item>& items, std::string_view path) {
  const auto found = std::find_if(items.begin(), items.end(), [&](const Item& one) {
    return one.path == path;
  });
  return found == items.end() ? nullptr : &*found;
}

// Why a request is not served at all, before anybody looks at its path; null if it is.
const char* refusal(const HttpRequest& request, std::string_view host) {
  if (request.only("host") != host) {
    return "421 Misdirected Request";
  }
  if (request.method != "GET" && request.method != "HEAD") {
    return "405 Method Not Allowed";
  }
  return request.is_upgrade() ? kForbidden : nullptr;  // may_upgrade() has said no
}

}  // namespace

ViewServer::Parts::Parts(ViewServerOptions wanted, ViewApplication& app)
    : options(std::move(wanted)), application(app) {}

ViewServer::Parts::~Parts() {
  ::close(acceptor);
}

void ViewServer::Parts::listen() {
  acceptor = listen_on_loopback(options.port);
  if (acceptor < 0) {
    throw InputError(fmt::format("cannot listen on 127.0.0.1:{}: {}", options.port,
                                 std::strerror(errno)));
  }
  host = fmt::format("127.0.0.1:{}", options.port);
  policy = content_policy(host);
}

void ViewServer::Parts::serve_until(std::int64_t due_ns) {
  std::vector<pollfd> ends = {{acceptor, POLLIN, 0}};
  for (const auto& connection : connections) {
    ends.push_back(connection->waits_for());
    due_ns = std::min(due_ns, connection->due_ns());
  }
  wait_for_sockets(ends, due_ns);
  for (std::size_t i = 0; i < connections.size(); ++i) {
    connections[i]->serve(ends[i + 1].revents != 0);
  }
  sweep();
  if (ends[0].revents != 0) {
    accept();
  }
}

void ViewServer::Parts::accept() {
  const int descriptor = accept_connection(acceptor);
  if (descriptor < 0) {
    return;
  }
  if (connections.size() >= kConnectionsMax) {
    // Connections that say nothing must not keep the page's own requests out.
    const auto idlest = std::min_element(connections.begin(), connections.end(),
                                         [](const auto& a, const auto& b) {
                                           return std::pair(a->client(), a->due_ns()) <
                                                  std::pair(b->client(), b->due_ns());
                                         });
    (*idlest)->end();
    sweep();
  }
  connections.push_back(std::make_unique<Connection>(*this, descriptor));
}

void ViewServer::Parts::sweep() {
  for (const auto& connection : connections) {
    if (connection->has_ended() && connection->client() != 0) {
      application.closed(connection->client());
    }
  }
  std::erase_if(connections, [](const auto& connection) {
    return connection->has_ended();
  });
}

std::size_t ViewServer::Parts::clients() const {
  return static_cast<std::size_t>(
      std::count_if(connections.begin(), connections.end(), [](const auto& connection) {
        return connection->client() != 0;
      }));
}

ViewServer::Parts::Connection* ViewServer::Parts::connection(ViewClient client) const {
  const auto found = std::find_if(connections.begin(), connections.end(),
                                  [client](const auto& connection) {
                                    return connection->client() == client;
                                  });
  return found == connections.end() ? nullptr : found->get();
}

bool ViewServer::Parts::may_upgrade(const HttpRequest& request) const {
  return request.is_upgrade() && request.only("host") == host &&
         request.only("origin") == "http://" + host && request.target == "/live" &&
         request.only("sec-websocket-version") == "13" &&
         request.only("sec-websocket-key").size() == 24 &&
         clients() < options.clients_max &&
         brings_token(request.only("sec-websocket-protocol"), options.token);
}

std::string ViewServer::Parts::answer(const HttpRequest& request) const {
  const char* status = refusal(request, host);
  std::string_view type = "text/plain; charset=utf-8";
  std::string_view body;
  if (status != nullptr) {
    // as it says
  } else if (const auto* asset = at_path(options.assets, request.target)) {
    status = kOk;
    type = asset->content_type;
    body = asset->bytes;
  } else if (const auto* data = at_path(options.data, request.target)) {
    const bool known =
        same_token(request.only("authorization"), "Bearer " + options.token);
    status = known ? kOk : kForbidden;
    type = data->content_type;
    body = known ? std::string_view(data->bytes) : "";
  } else {
    status = "404 Not Found";
  }
  return fmt::format(
      "HTTP/1.1 {}\r\n{}Content-Type: {}\r\nCache-Control: no-store\r\n"
      "Content-Security-Policy: {}\r\nX-Content-Type-Options: nosniff\r\n"
      "Referrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n"
      "Cross-Origin-Opener-Policy: same-origin\r\nContent-Length: {}\r\n\r\n{}",
      status, request.goes_on ? "" : "Connection: close\r\n", type, policy, body.size(),
      request.method == "HEAD" ? "" : body);
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
  return parts_->options.port;
}

std::string ViewServer::address() const {
  return fmt::format("http://{}/#{}", parts_->host, parts_->options.token);
}

void ViewServer::run(const std::atomic<bool>& stop) {
  const std::int64_t period_ns = nanoseconds_in(1.0 / parts_->options.frame_hz);
  std::int64_t frame_ns = parts_->clock.now_ns() + period_ns;
  while (!stop.load()) {
    parts_->serve_until(frame_ns);
    if (parts_->clock.now_ns() >= frame_ns) {
      parts_->application.frame();
      frame_ns = parts_->clock.now_ns() + period_ns;
    }
  }
}

void ViewServer::send(ViewClient client, std::string text) {
  if (auto* const connection = parts_->connection(client)) {
    connection->send(std::move(text));
  }
}

void ViewServer::send_latest(ViewClient client,
                             const std::shared_ptr<const std::string>& text) {
  if (auto* const connection = parts_->connection(client)) {
    connection->send_latest(text);
  }
}

}  // namespace palpate
