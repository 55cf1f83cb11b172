// What the live view's server refuses, spoken to over a plain socket.
#include "runtime/view/view_server.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "runtime/view/view_message.h"

namespace palpate {
namespace {

const std::string kToken = "0123456789abcdef0123456789abcdef";

// Answers "echo" with the message, keeps who came and went.
class Echo : public ViewApplication {
 public:
  void opened(ViewClient) override { ++open; }
  void received(ViewClient client, std::string_view text) override {
    ++messages;
    outbox->send(client, std::string(text));
  }
  void closed(ViewClient) override { --open; }
  void frame() override { ++frames; }

  ViewOutbox* outbox = nullptr;
  std::atomic<int> open = 0;
  std::atomic<int> messages = 0;
  std::atomic<int> frames = 0;
};

// A client that says exactly what a test wants it to say.
class Client {
 public:
  explicit Client(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{.tv_sec = 10, .tv_usec = 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) {
      throw InputError("test: cannot connect");
    }
  }
  ~Client() { ::close(socket_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void send(const std::string& text) const {
    static_cast<void>(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL));
  }

  // Up to and with `end`, or what came until the connection ended.
  [[nodiscard]] std::string read_until(const std::string& end) const {
    std::string text;
    char byte = 0;
    while (text.find(end) == std::string::npos && ::recv(socket_, &byte, 1, 0) == 1) {
      text += byte;
    }
    return text;
  }

  // A text frame of a client: masked, with a mask of zeros.
  void send_frame(const std::string& text) const {
    std::string frame = "\x81";
    if (text.size() < 126) {
      frame += static_cast<char>(0x80U | text.size());
    } else {
      frame += static_cast<char>(0x80U | 126U);
      frame += static_cast<char>(text.size() >> 8U);
      frame += static_cast<char>(text.size() & 0xffU);
    }
    send(frame + std::string(4, '\0') + text);
  }

  // The next frame's first byte, length byte and short payload; empty at the end.
  [[nodiscard]] std::string read_frame() const {
    std::string head(2, '\0');
    if (::recv(socket_, head.data(), 2, MSG_WAITALL) != 2) {
      return "";
    }
    std::string payload(static_cast<unsigned char>(head[1]) & 0x7fU, '\0');
    if (!payload.empty() &&
        ::recv(socket_, payload.data(), payload.size(), MSG_WAITALL) !=
            static_cast<ssize_t>(payload.size())) {
      return "";
    }
    return head + payload;
  }

 private:
  int socket_;
};

class ViewServerTest : public testing::Test {
 protected:
  void SetUp() override {
    ViewServerOptions options;
    options.token = kToken;
    options.assets = {{"/", "text/html", "the page"}};
    options.data = {{"/body.json", "application/json", "{}"}};
    options.clients_max = 2;
    options.messages_per_s_max = 50.0;
    server_ = std::make_unique<ViewServer>(options, echo_);
    echo_.outbox = server_.get();
    host_ = fmt::format("127.0.0.1:{}", server_->port());
    thread_ = std::thread([this] {
      server_->run(stop_);
    });
  }
  void TearDown() override {
    stop_ = true;
    thread_.join();
  }

  [[nodiscard]] Client client() const { return Client(server_->port()); }

  // Status of an answer to a request as it stands.
  [[nodiscard]] int status(const std::string& request) const {
    const Client one = client();
    one.send(request);
    const std::string answer = one.read_until("\r\n\r\n");
    return answer.size() > 12 ? std::stoi(answer.substr(9, 3)) : 0;
  }

  [[nodiscard]] std::string get(const std::string& path,
                                const std::string& more = "") const {
    return fmt::format("GET {} HTTP/1.1\r\nHost: {}\r\n{}\r\n", path, host_, more);
  }

  struct Upgrade {
    std::string path = "/live";
    std::string host;
    std::string origin;
    std::string protocol = "palpate.1, " + kToken;
  };
  [[nodiscard]] Upgrade right() const {
    return {.host = host_, .origin = "http://" + host_};
  }
  [[nodiscard]] static std::string text(const Upgrade& up) {
    return fmt::format(
        "GET {} HTTP/1.1\r\nHost: {}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
        "Sec-WebSocket-Protocol: {}\r\n{}\r\n",
        up.path, up.host, up.protocol,
        up.origin.empty() ? "" : "Origin: " + up.origin + "\r\n");
  }

  Echo echo_;
  std::unique_ptr<ViewServer> server_;
  std::string host_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

TEST_F(ViewServerTest, ServesThePageToTheRightHostOnly) {
  EXPECT_EQ(status(get("/")), 200);
  EXPECT_EQ(status("GET / HTTP/1.1\r\n\r\n"), 421);
  EXPECT_EQ(status("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"), 421);
  EXPECT_EQ(status(fmt::format("GET / HTTP/1.1\r\nHost: localhost:{}\r\n\r\n",
                               server_->port())),
            421);
  EXPECT_EQ(status(fmt::format("GET / HTTP/1.1\r\nHost: evil.example:{}\r\n\r\n",
                               server_->port())),
            421);
  EXPECT_EQ(
      status(fmt::format("GET / HTTP/1.1\r\nHost: {0}\r\nHost: {0}\r\n\r\n", host_)),
      421);
}

TEST_F(ViewServerTest, KnowsNoOtherFilesAndNoOtherMethods) {
  EXPECT_EQ(status(get("/../etc/passwd")), 404);
  EXPECT_EQ(status(get("/index.html")), 404);
  EXPECT_EQ(status(fmt::format(
                "POST / HTTP/1.1\r\nHost: {}\r\nContent-Length: 0\r\n\r\n", host_)),
            405);
}

TEST_F(ViewServerTest, EveryAnswerCarriesTheContentPolicy) {
  const Client one = client();
  one.send(get("/missing"));
  const std::string answer = one.read_until("\r\n\r\n");
  EXPECT_NE(answer.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(answer.find("unsafe"), std::string::npos);
  EXPECT_NE(answer.find("nosniff"), std::string::npos);
}

TEST_F(ViewServerTest, DataNeedsTheToken) {
  EXPECT_EQ(status(get("/body.json")), 403);
  EXPECT_EQ(status(get("/body.json",
                       "Authorization: Bearer " + std::string(32, '0') + "\r\n")),
            403);
  EXPECT_EQ(status(get("/body.json", "Authorization: Bearer " + kToken + "\r\n")), 200);
}

TEST_F(ViewServerTest, RefusesHeadersAndBodiesThatAreTooLong) {
  EXPECT_NE(status(get("/", "X-Long: " + std::string(10000, 'x') + "\r\n")), 200);
  EXPECT_NE(status(fmt::format("GET / HTTP/1.1\r\nHost: {}\r\nContent-Length: 9\r\n\r\n"
                               "unwanted!",
                               host_)),
            200);
  EXPECT_EQ(status(get("/")), 200);  // and lives on
}

TEST_F(ViewServerTest, UpgradesThePageAndNobodyElse) {
  EXPECT_EQ(status(text(right())), 101);
  Upgrade up = right();
  up.origin = "http://evil.example";
  EXPECT_EQ(status(text(up)), 403);
  up.origin = "";
  EXPECT_EQ(status(text(up)), 403);
  up = right();
  up.host = "evil.example";
  EXPECT_EQ(status(text(up)), 421);
  up = right();
  up.protocol = "palpate.1";
  EXPECT_EQ(status(text(up)), 403);
  up.protocol = "palpate.1, " + std::string(32, '0');
  EXPECT_EQ(status(text(up)), 403);
  up.protocol = "palpate.1, " + kToken.substr(0, 31);
  EXPECT_EQ(status(text(up)), 403);
  up = right();
  up.path = "/";
  EXPECT_EQ(status(text(up)), 403);
}

TEST_F(ViewServerTest, AnswersAMessageAndNoticesTheEnd) {
  {
    const Client one = client();
    one.send(text(right()));
    EXPECT_NE(one.read_until("\r\n\r\n").find(" 101 "), std::string::npos);
    one.send_frame("hello");
    EXPECT_EQ(one.read_frame(), "\x81\x05hello");
    EXPECT_EQ(echo_.open, 1);
  }
  for (int i = 0; i < 500 && echo_.open != 0; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_EQ(echo_.open, 0);
}

TEST_F(ViewServerTest, AnswersRequestsOneAfterTheOther) {
  const Client one = client();
  one.send(get("/") + get("/missing") + text(right()));
  EXPECT_NE(one.read_until("the page").find(" 200 "), std::string::npos);
  EXPECT_NE(one.read_until("\r\n\r\n").find(" 404 "), std::string::npos);
  EXPECT_NE(one.read_until("\r\n\r\n").find(" 101 "), std::string::npos);
  one.send_frame("hello");
  EXPECT_EQ(one.read_frame(), "\x81\x05hello");
}

TEST_F(ViewServerTest, EndsWhereTheClientWantsNoMore) {
  const Client one = client();
  one.send(get("/", "Connection: close\r\n"));
  EXPECT_NE(one.read_until("never").find("the page"), std::string::npos);
  const Client two = client();
  two.send(text(right()));
  static_cast<void>(two.read_until("\r\n\r\n"));
  two.send("\x88\x82" + std::string(4, '\0') + "\x03\xe8");  // 1000
  EXPECT_EQ(two.read_frame(), "\x88\x02\x03\xe8");
  EXPECT_EQ(two.read_frame(), "");
}

TEST_F(ViewServerTest, DropsWhatIsNoTextOfAClient) {
  for (const auto& [frame, code] :
       {std::pair{"\x82\x81" + std::string(4, '\0') + "x", "\x03\xeb"},  // 1003
        std::pair{std::string("\x81\x01x"), "\x03\xea"}}) {  // 1002: no mask
    const Client one = client();
    one.send(text(right()));
    static_cast<void>(one.read_until("\r\n\r\n"));
    one.send(frame);
    EXPECT_EQ(one.read_frame(), std::string("\x88\x02") + code);
  }
  EXPECT_EQ(echo_.messages, 0);
}

TEST_F(ViewServerTest, DropsAnOversizedMessageUnread) {
  const Client one = client();
  one.send(text(right()));
  static_cast<void>(one.read_until("\r\n\r\n"));
  one.send_frame(std::string(kViewMessageBytes + 1, 'x'));
  const std::string frame = one.read_frame();
  ASSERT_GE(frame.size(), 4U);
  EXPECT_EQ(frame[0], '\x88');                // close
  EXPECT_EQ(frame.substr(2, 2), "\x03\xf1");  // 1009, too big
  EXPECT_EQ(echo_.messages, 0);
}

TEST_F(ViewServerTest, DropsAClientThatTalksTooMuch) {
  const Client one = client();
  one.send(text(right()));
  static_cast<void>(one.read_until("\r\n\r\n"));
  for (int i = 0; i < 200; ++i) {
    one.send_frame("x");
  }
  std::string last;
  for (std::string frame = one.read_frame(); !frame.empty(); frame = one.read_frame()) {
    last = frame;
    if (frame[0] == '\x88') {
      break;
    }
  }
  ASSERT_GE(last.size(), 4U);
  EXPECT_EQ(last.substr(2, 2), "\x03\xf0");  // 1008, policy
  EXPECT_LT(echo_.messages, 200);
}

TEST_F(ViewServerTest, DropsAClientThatFloodsItWithPings) {
  const Client one = client();
  one.send(text(right()));
  static_cast<void>(one.read_until("\r\n\r\n"));
  const std::string ping = "\x89\x80" + std::string(4, '\0');  // masked, empty
  for (int i = 0; i < 500; ++i) {
    one.send(ping);
  }
  std::string last;
  int pongs = 0;
  for (std::string frame = one.read_frame(); !frame.empty(); frame = one.read_frame()) {
    last = frame;
    pongs += frame[0] == '\x8a' ? 1 : 0;
    if (frame[0] == '\x88') {
      break;
    }
  }
  ASSERT_GE(last.size(), 4U);
  EXPECT_EQ(last.substr(2, 2), "\x03\xf0");  // 1008, policy
  EXPECT_GT(pongs, 0);                       // a page's own keep-alive is answered
  EXPECT_LT(pongs, 100);
}

// More of them than there is room for: the idlest makes place.
TEST_F(ViewServerTest, ConnectionsThatSayNothingDoNotKeepThePageOut) {
  std::vector<std::unique_ptr<Client>> silent;
  for (int i = 0; i < 60; ++i) {
    silent.push_back(std::make_unique<Client>(server_->port()));
    if (i % 10 == 9) {
      EXPECT_EQ(status(get("/")), 200) << i;
    }
  }
}

TEST_F(ViewServerTest, HasRoomForItsClientsAndNoMore) {
  const Client one = client();
  const Client two = client();
  for (const Client* each : {&one, &two}) {
    each->send(text(right()));
    EXPECT_NE(each->read_until("\r\n\r\n").find(" 101 "), std::string::npos);
  }
  EXPECT_EQ(status(text(right())), 403);
}

TEST(ViewServer, APortInUseIsAnInputError) {
  Echo echo;
  const ViewServer one({.token = kToken}, echo);
  EXPECT_THROW(ViewServer({.port = one.port(), .token = kToken}, echo), InputError);
}

}  // namespace
}  // namespace palpate
