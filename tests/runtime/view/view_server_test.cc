// The live view's server against strangers on the same machine, by raw sockets.
#include "runtime/view/view_server.h"

#include <array>
#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace palpate {
namespace {

class Quiet : public ViewApplication {
 public:
  void opened(ViewClient /*client*/) override {}
  void received(ViewClient /*client*/, std::string_view /*text*/) override {}
  void closed(ViewClient /*client*/) override { ++gone; }
  void frame() override {}
  std::atomic<int> gone = 0;
};

class Connection {
 public:
  explicit Connection(std::uint16_t port)
      : descriptor_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(descriptor_, reinterpret_cast<const sockaddr*>(&address),
                        sizeof address),
              0);
  }
  ~Connection() { ::close(descriptor_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  bool say(const std::string& bytes) const {
    return ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(bytes.size());
  }

  // What comes until the text is in it, the other end closes, or 5 s have passed.
  std::string hear_until(const std::string& text) {
    std::array<char, 4096> piece{};
    std::string heard;
    while (heard.find(text) == std::string::npos) {
      pollfd end{.fd = descriptor_, .events = POLLIN, .revents = 0};
      if (::poll(&end, 1, 5000) != 1) {
        break;
      }
      const ssize_t got = ::recv(descriptor_, piece.data(), piece.size(), 0);
      if (got <= 0) {
        closed = true;
        break;
      }
      heard.append(piece.data(), static_cast<std::size_t>(got));
    }
    return heard;
  }

  bool closed = false;

 private:
  int descriptor_;
};

class ViewServerTest : public testing::Test {
 protected:
  ViewServerTest()
      : thread_([this] {
          server_.run(stop_);
        }) {}
  ~ViewServerTest() override {
    stop_ = true;
    thread_.join();
  }

  std::string host() const {
    return "Host: 127.0.0.1:" + std::to_string(server_.port()) + "\r\n";
  }

  static ViewServerOptions options() {
    ViewServerOptions all;
    all.token = std::string(32, 'a');
    all.assets = {{"/", "text/html", "the page"}};
    return all;
  }

  Quiet application_;
  ViewServer server_{options(), application_};
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

TEST_F(ViewServerTest, ConnectionsThatSayNothingDoNotKeepThePageOut) {
  std::vector<std::unique_ptr<Connection>> silent;
  for (int i = 0; i < 60; ++i) {
    silent.push_back(std::make_unique<Connection>(server_.port()));
    if (i % 10 == 9) {
      Connection page(server_.port());
      ASSERT_TRUE(page.say("GET / HTTP/1.1\r\n" + host() + "\r\n"));
      EXPECT_NE(page.hear_until("the page").find("200 OK"), std::string::npos) << i;
    }
  }
}

TEST_F(ViewServerTest, AFloodOfPingsEndsTheSocket) {
  Connection page(server_.port());
  ASSERT_TRUE(page.say("GET /live HTTP/1.1\r\n" + host() +
                       "Origin: http://127.0.0.1:" + std::to_string(server_.port()) +
                       "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                       "Sec-WebSocket-Version: 13\r\n"
                       "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
                       "Sec-WebSocket-Protocol: palpate.1, " +
                       std::string(32, 'a') + "\r\n\r\n"));
  ASSERT_NE(page.hear_until("\r\n\r\n").find("101 Switching"), std::string::npos);
  const std::string ping("\x89\x80\x01\x02\x03\x04", 6);  // masked, empty
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(page.say(ping));  // a page's own keep-alive
  }
  for (int i = 0; i < 5000 && page.say(ping); ++i) {
  }
  const std::string close("\x88\x02\x03\xf0", 4);  // 1008, policy violated
  EXPECT_NE(page.hear_until(close).find(close), std::string::npos);
}

}  // namespace
}  // namespace palpate
