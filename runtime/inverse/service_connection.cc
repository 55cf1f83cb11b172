#include "runtime/inverse/service_connection.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <random>
#include <span>
#include <utility>

#include <arpa/inet.h>
#include <boost/beast/http.hpp>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <openssl/evp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

namespace http = boost::beast::http;

[[noreturn]] void fail(std::uint16_t port, const std::string& why) {
  throw DeviceError(fmt::format("no Inverse service at 127.0.0.1:{}: {}", port, why));
}

// A connected socket that never waits.
class Connection {
 public:
  Connection(std::uint16_t port, std::int64_t deadline_ns)
      : descriptor(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
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

// Reads until the parser has what it wants. @returns bytes after that.
template <typename Parser>
std::string read_answer(int descriptor, std::uint16_t port, Parser& parser, bool whole,
                        std::int64_t deadline_ns) {
  constexpr std::size_t kMost = 16384;
  std::string bytes;
  std::array<char, 2048> piece{};
  const auto enough = [&] {
    return whole ? parser.is_done() : parser.is_header_done();
  };
  while (!enough()) {
    if (!wait_for_socket(descriptor, POLLIN, deadline_ns)) {
      fail(port, "does not answer a request in time");
    }
    const ssize_t got = ::recv(descriptor, piece.data(), piece.size(), 0);
    boost::beast::error_code failure;
    if (got == 0 && whole && parser.is_header_done()) {
      parser.put_eof(failure);  // a body that ends with the connection
      if (failure || !parser.is_done()) {
        fail(port, "ends in the middle of its answer");
      }
      break;
    }
    if (got <= 0) {
      fail(port, "closes the connection instead of an answer");
    }
    bytes.append(piece.data(), static_cast<std::size_t>(got));
    while (!bytes.empty() && !enough()) {
      const std::size_t used =
          parser.put(boost::asio::buffer(bytes.data(), bytes.size()), failure);
      bytes.erase(0, used);
      if (failure == http::error::need_more || (!failure && used == 0)) {
        break;
      }
      if (failure) {
        fail(port, "what answers speaks no HTTP (" + failure.message() + ")");
      }
    }
    if (bytes.size() > kMost) {
      fail(port, "its answer is too long");
    }
  }
  return bytes;
}

std::string base64(std::span<const unsigned char> bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int size = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                   bytes.data(), static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(size));
  return text;
}

// What the other side must answer to a key (RFC 6455, section 1.3).
std::string accept_of(const std::string& key) {
  const std::string text = key + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11";
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  EVP_Digest(text.data(), text.size(), digest.data(), &size, EVP_sha1(), nullptr);
  return base64(std::span(digest).first(size));
}

}  // namespace

std::int64_t inverse_deadline_ns(double wait_s) noexcept {
  MonotonicClock clock;
  return clock.now_ns() + std::llround(wait_s * kNanosecondsPerSecond);
}

bool wait_for_socket(int descriptor, short events, std::int64_t deadline_ns) noexcept {
  MonotonicClock clock;
  pollfd end{.fd = descriptor, .events = events, .revents = 0};
  for (;;) {
    const std::int64_t left_ns =
        std::max<std::int64_t>(deadline_ns - clock.now_ns(), 0);
    const timespec left{.tv_sec = left_ns / 1'000'000'000,
                        .tv_nsec = left_ns % 1'000'000'000};
    const int ready = ::ppoll(&end, 1, &left, nullptr);
    if (ready > 0 || (ready < 0 && errno != EINTR)) {
      return true;
    }
    if (ready == 0) {
      return false;
    }
  }
}

std::string http_get(std::uint16_t port, const std::string& target, double wait_s) {
  const std::int64_t deadline_ns = inverse_deadline_ns(wait_s);
  const Connection connection(port, deadline_ns);
  send_request(connection.descriptor, port, target, "Connection: close\r\n");
  http::response_parser<http::string_body> parser;
  parser.body_limit(4096);
  parser.eager(true);
  read_answer(connection.descriptor, port, parser, true, deadline_ns);
  if (parser.get().result() != http::status::ok) {
    fail(port,
         fmt::format("GET {} is answered by {}", target, parser.get().result_int()));
  }
  return parser.get().body();
}

OpenedWebSocket open_websocket(std::uint16_t port, double wait_s) {
  const std::int64_t deadline_ns = inverse_deadline_ns(wait_s);
  Connection connection(port, deadline_ns);
  std::random_device random;
  std::array<unsigned char, 16> nonce{};
  for (unsigned char& byte : nonce) {
    byte = static_cast<unsigned char>(random());
  }
  const std::string key = base64(nonce);
  send_request(connection.descriptor, port, "/",
               "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: "
               "13\r\nSec-WebSocket-Key: " +
                   key + "\r\n");
  http::response_parser<http::empty_body> parser;
  parser.skip(true);  // what follows are frames
  std::string rest =
      read_answer(connection.descriptor, port, parser, false, deadline_ns);
  const auto& answer = parser.get();
  if (answer.result() != http::status::switching_protocols ||
      answer["Sec-WebSocket-Accept"] != accept_of(key)) {
    fail(port, fmt::format("no WebSocket there: answered by {}", answer.result_int()));
  }
  return {.descriptor = std::exchange(connection.descriptor, -1),
          .rest = std::move(rest)};
}

}  // namespace palpate
