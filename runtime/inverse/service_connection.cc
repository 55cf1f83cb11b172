#include "runtime/inverse/service_connection.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "runtime/inverse/websocket_handshake.h"
#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

constexpr std::size_t kBodyBytes = 4096;

[[noreturn]] void fail(std::uint16_t port, const std::string& why) {
  throw DeviceError(fmt::format("no Inverse service at 127.0.0.1:{}: {}", port, why));
}

sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

// A connected socket that never waits.
class Connection {
 public:
  Connection(std::uint16_t port, std::int64_t deadline_ns)
      : descriptor(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
    const sockaddr_in address = loopback(port);
    int error = 0;
    if (::connect(descriptor, reinterpret_cast<const sockaddr*>(&address),
                  sizeof address) != 0) {
      error = errno;
    }
    if (error == EINPROGRESS) {
      socklen_t size = sizeof error;
      error = ETIMEDOUT;
      if (wait_for_socket(descriptor, POLLOUT, deadline_ns)) {
        ::getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &error, &size);
      }
    }
    if (error != 0) {
      close();
      fail(port, std::strerror(error));
    }
    const int on = 1;
    ::setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  }
  ~Connection() { close(); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void close() {
    if (descriptor >= 0) {
      ::close(std::exchange(descriptor, -1));
    }
  }

  int descriptor;
};

void send_request(int descriptor, std::uint16_t port, const std::string& target,
                  const std::string& fields) {
  const std::string request = fmt::format(
      "GET {} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n{}\r\n", target, port, fields);
  // A fresh socket's buffer takes it whole.
  if (::send(descriptor, request.data(), request.size(), MSG_NOSIGNAL) !=
      static_cast<ssize_t>(request.size())) {
    fail(port, std::strerror(errno));
  }
}

// Appends what comes. False at the end of the connection.
bool read_more(int descriptor, std::uint16_t port, std::string& bytes,
               std::int64_t deadline_ns) {
  if (!wait_for_socket(descriptor, POLLIN, deadline_ns)) {
    fail(port, "does not answer a request in time");
  }
  std::array<char, 2048> piece{};
  const ssize_t got = ::recv(descriptor, piece.data(), piece.size(), 0);
  if (got < 0) {
    fail(port, "closes the connection instead of an answer");
  }
  bytes.append(piece.data(), static_cast<std::size_t>(got));
  return got > 0;
}

// "HTTP/1.1 200 OK": 200. Zero for what is no status line.
unsigned status_of(const std::string& head) {
  const std::string line = head.substr(0, head.find("\r\n"));
  if (line.size() < 12 || (line[7] != '0' && line[7] != '1') || line[8] != ' ' ||
      (line.size() > 12 && line[12] != ' ')) {
    return 0;
  }
  unsigned status = 0;
  const char* const end = line.data() + 12;
  return std::from_chars(end - 3, end, status).ptr == end ? status : 0;
}

struct HttpAnswer {
  unsigned status = 0;
  std::string head{};
  std::string rest{};  // bytes after it
};

HttpAnswer read_answer(int descriptor, std::uint16_t port, std::int64_t deadline_ns) {
  constexpr std::string_view kVersion = "HTTP/1.";
  std::string bytes;
  std::optional<std::string> head;
  while (!head) {
    if (!read_more(descriptor, port, bytes, deadline_ns)) {
      fail(port, "closes the connection instead of an answer");
    }
    if (bytes.compare(0, kVersion.size(), kVersion, 0, bytes.size()) != 0) {
      fail(port, "what answers speaks no HTTP (its version)");
    }
    if (bytes.size() > kHttpHeadBytes) {
      fail(port, "its answer is too long");
    }
    head = take_http_head(bytes);
  }
  const unsigned status = status_of(*head);
  if (status == 0) {
    fail(port, "what answers speaks no HTTP (its status)");
  }
  return {.status = status, .head = std::move(*head), .rest = std::move(bytes)};
}

std::size_t body_size(std::uint16_t port, std::string_view digits, int base) {
  std::size_t size = 0;
  if (std::from_chars(digits.data(), digits.data() + digits.size(), size, base).ec !=
      std::errc{}) {
    fail(port, "what answers speaks no HTTP (its body)");
  }
  return size;
}

// A body in chunks (RFC 9112, section 7.1); null while it is not whole.
std::optional<std::string> join_chunks(std::uint16_t port, std::string_view bytes) {
  std::string body;
  for (std::size_t end = 0; (end = bytes.find("\r\n")) != std::string_view::npos;) {
    const std::size_t size = body_size(port, bytes.substr(0, end), 16);
    if (size == 0) {
      return body;
    }
    bytes.remove_prefix(end + 2);
    if (bytes.size() < 2 || bytes.size() - 2 < size) {
      break;
    }
    body += bytes.substr(0, size);
    bytes.remove_prefix(size + 2);
  }
  return std::nullopt;
}

// The same of any body (section 6.3). @param ended whether the connection did.
std::optional<std::string> body_of(std::uint16_t port, const HttpAnswer& answer,
                                   bool ended) {
  if (lower_case(http_field(answer.head, "transfer-encoding")) == "chunked") {
    return join_chunks(port, answer.rest);
  }
  const std::string length = http_field(answer.head, "content-length");
  const std::size_t have = answer.rest.size();
  const std::size_t size =
      length.empty() ? have + (ended ? 0 : 1) : body_size(port, length, 10);
  return have < size ? std::nullopt : std::optional(answer.rest.substr(0, size));
}

}  // namespace

std::int64_t inverse_deadline_ns(double wait_s) noexcept {
  MonotonicClock clock;
  return clock.now_ns() + std::llround(wait_s * kNanosecondsPerSecond);
}

bool wait_for_sockets(std::span<pollfd> ends, std::int64_t deadline_ns) noexcept {
  MonotonicClock clock;
  for (;;) {
    const std::int64_t left_ns =
        std::max<std::int64_t>(deadline_ns - clock.now_ns(), 0);
    const timespec left{.tv_sec = left_ns / 1'000'000'000,
                        .tv_nsec = left_ns % 1'000'000'000};
    const int ready = ::ppoll(ends.data(), ends.size(), &left, nullptr);
    if (ready > 0 || (ready < 0 && errno != EINTR)) {
      return true;
    }
    if (ready == 0) {
      return false;
    }
  }
}

bool wait_for_socket(int descriptor, short events, std::int64_t deadline_ns) noexcept {
  pollfd end{.fd = descriptor, .events = events, .revents = 0};
  return wait_for_sockets(std::span(&end, 1), deadline_ns);
}

int listen_on_loopback(std::uint16_t& port) noexcept {
  const int descriptor =
      ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int on = 1;
  sockaddr_in address = loopback(port);
  auto* const any = reinterpret_cast<sockaddr*>(&address);
  socklen_t size = sizeof address;
  if (descriptor < 0 ||
      ::setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) != 0 ||
      ::bind(descriptor, any, size) != 0 || ::listen(descriptor, SOMAXCONN) != 0 ||
      ::getsockname(descriptor, any, &size) != 0) {
    const int why = errno;
    ::close(descriptor);
    errno = why;
    return -1;
  }
  port = ntohs(address.sin_port);
  return descriptor;
}

int accept_connection(int acceptor) noexcept {
  const int descriptor =
      ::accept4(acceptor, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  const int on = 1;
  ::setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return descriptor;
}

std::string http_get(std::uint16_t port, const std::string& target, double wait_s) {
  const std::int64_t deadline_ns = inverse_deadline_ns(wait_s);
  const Connection connection(port, deadline_ns);
  send_request(connection.descriptor, port, target, "Connection: close\r\n");
  HttpAnswer answer = read_answer(connection.descriptor, port, deadline_ns);
  if (answer.status != 200) {
    fail(port, fmt::format("GET {} is answered by {}", target, answer.status));
  }
  bool ended = false;
  std::optional<std::string> body;
  while (!(body = body_of(port, answer, ended))) {
    if (ended) {
      fail(port, "ends in the middle of its answer");
    }
    ended = !read_more(connection.descriptor, port, answer.rest, deadline_ns);
    if (answer.rest.size() > kBodyBytes) {
      fail(port, "its answer is too long");
    }
  }
  return *body;
}

OpenedWebSocket open_websocket(std::uint16_t port, double wait_s) {
  const std::int64_t deadline_ns = inverse_deadline_ns(wait_s);
  Connection connection(port, deadline_ns);
  const std::string key = websocket_key();
  send_request(connection.descriptor, port, "/",
               "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: "
               "13\r\nSec-WebSocket-Key: " +
                   key + "\r\n");
  HttpAnswer answer = read_answer(connection.descriptor, port, deadline_ns);
  if (answer.status != 101 ||
      http_field(answer.head, "sec-websocket-accept") != websocket_accept(key)) {
    fail(port, fmt::format("no WebSocket there: answered by {}", answer.status));
  }
  return {.descriptor = std::exchange(connection.descriptor, -1),
          .rest = std::move(answer.rest)};
}

}  // namespace palpate
