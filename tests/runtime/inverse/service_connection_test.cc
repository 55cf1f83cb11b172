// Whatever holds the port of a service: its answer is taken, or refused in one
// sentence.
#include "runtime/inverse/service_connection.h"

#include <array>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "runtime/inverse/emulated_inverse.h"

namespace palpate {
namespace {

// Answers one request with these bytes, and closes, or waits for the other end to.
class OneAnswer {
 public:
  OneAnswer(const std::string& answer, bool closes)
      : listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    auto* const any = reinterpret_cast<sockaddr*>(&address);
    socklen_t size = sizeof address;
    EXPECT_EQ(::bind(listener_, any, size), 0);
    EXPECT_EQ(::listen(listener_, 1), 0);
    ::getsockname(listener_, any, &size);
    port = ntohs(address.sin_port);
    thread_ = std::thread([this, answer, closes] {
      const int socket = ::accept(listener_, nullptr, nullptr);
      std::array<char, 4096> request{};
      static_cast<void>(::recv(socket, request.data(), request.size(), 0));
      // In two pieces, so that one ends in the middle of something.
      const std::size_t half = answer.size() / 2;
      static_cast<void>(::send(socket, answer.data(), half, MSG_NOSIGNAL));
      ::usleep(2000);
      static_cast<void>(
          ::send(socket, answer.data() + half, answer.size() - half, MSG_NOSIGNAL));
      if (!closes) {
        static_cast<void>(::recv(socket, request.data(), request.size(), 0));
      }
      ::close(socket);
    });
  }
  ~OneAnswer() {
    thread_.join();
    ::close(listener_);
  }
  OneAnswer(const OneAnswer&) = delete;
  OneAnswer& operator=(const OneAnswer&) = delete;

  std::uint16_t port = 0;

 private:
  int listener_;
  std::thread thread_;
};

std::string get(const std::string& answer, bool closes = false) {
  const OneAnswer server(answer, closes);
  try {
    return http_get(server.port, "/version", 0.3);
  } catch (const DeviceError& error) {
    return error.what();
  }
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(ServiceConnection, TakesABodyOfEachSpelling) {
  const std::string head = "HTTP/1.1 200 OK\r\n";
  EXPECT_EQ(get(head + "Content-Length: 5\r\n\r\nHello, and more"), "Hello");
  EXPECT_EQ(get(head + "content-length: 0\r\n\r\n"), "");
  EXPECT_EQ(get("HTTP/1.0 200\r\n\r\nHello", true), "Hello");
  EXPECT_EQ(get(head + "Transfer-Encoding: Chunked\r\n\r\n"
                       "3;a=b\r\nHel\r\nA\r\nlo, World!\r\n0\r\n\r\n"),
            "Hello, World!");
}

TEST(ServiceConnection, SaysWhyAnAnswerIsNone) {
  const std::string ok = "HTTP/1.1 200 OK\r\n";
  const std::string sized = ok + "Content-Length: ";
  const std::string chunked = ok + "Transfer-Encoding: chunked\r\n\r\n";
  EXPECT_TRUE(has(get("SSH-2.0-OpenSSH_9\r\n"), "speaks no HTTP"));
  EXPECT_TRUE(has(get("HTTP/2.0 200 OK\r\n\r\n"), "speaks no HTTP"));
  EXPECT_TRUE(has(get("HTTP/1.1 20x OK\r\n\r\n"), "speaks no HTTP"));
  EXPECT_TRUE(has(get("HTTP/1.1 2000\r\n\r\n"), "speaks no HTTP"));
  EXPECT_TRUE(has(get(sized + "five\r\n\r\nHello"), "speaks no HTTP"));
  EXPECT_TRUE(has(get(chunked + "x\r\nHello\r\n"), "speaks no HTTP"));
  EXPECT_TRUE(has(get(""), "does not answer a request in time"));
  EXPECT_TRUE(has(get(ok), "does not answer a request in time"));
  EXPECT_TRUE(has(get(sized + "6\r\n\r\nHello"), "does not answer a request in time"));
  EXPECT_TRUE(has(get(ok, true), "closes the connection instead of an answer"));
  EXPECT_TRUE(has(get(sized + "6\r\n\r\nHello", true), "ends in the middle"));
  EXPECT_TRUE(has(get(chunked + "5\r\nHello\r\n", true), "ends in the middle"));
  EXPECT_TRUE(has(get(chunked + "ffffffffffffffff\r\nHello", true), "the middle"));
  EXPECT_TRUE(has(get(ok + std::string(20000, 'a')), "answer is too long"));
  EXPECT_TRUE(has(get(ok + "\r\n" + std::string(20000, 'a')), "answer is too long"));
  EXPECT_TRUE(has(get("HTTP/1.1 503 Busy\r\n\r\n"), "GET /version is answered by 503"));
}

TEST(ServiceConnection, OpensAWebSocketWithTheKeysAnswerAlone) {
  const OneAnswer server(
      "HTTP/1.1 101 Switching Protocols\r\n"
      "Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n\r\n",
      false);
  EXPECT_THROW(static_cast<void>(open_websocket(server.port, 0.3)), DeviceError);
  EmulatedInverse service({});
  EXPECT_EQ(http_get(service.port(), "/version", 1.0), R"({"version":"3.5.1"})");
  try {
    static_cast<void>(http_get(service.events_port(), "/other", 1.0));
    ADD_FAILURE() << "answered";
  } catch (const DeviceError& error) {
    EXPECT_TRUE(has(error.what(), "GET /other is answered by 404")) << error.what();
  }
  const OpenedWebSocket opened = open_websocket(service.port(), 1.0);
  ::close(opened.descriptor);
}

}  // namespace
}  // namespace palpate
