// Heads of requests: what is taken, and what is none.
#include "runtime/view/view_request.h"

#include <string>

#include <gtest/gtest.h>

namespace palpate {
namespace {

HttpRequest of(const std::string& head) {
  const auto request = parse_http_request(head);
  EXPECT_TRUE(request) << head;
  return request.value_or(HttpRequest{});
}

TEST(HttpRequest, SaysWhatItAsksFor) {
  const HttpRequest request =
      of("GET /body.json HTTP/1.1\r\nHost: a:1\r\nX-Two: one\r\nACCEPT:\t*/* \r\n"
         "x-two: two\r\nEmpty:\r\n");
  EXPECT_EQ(request.method, "GET");
  EXPECT_EQ(request.target, "/body.json");
  EXPECT_TRUE(request.goes_on);
  EXPECT_EQ(request.only("host"), "a:1");
  EXPECT_EQ(request.only("accept"), "*/*");
  EXPECT_EQ(request.only("empty"), "");
  EXPECT_EQ(request.only("x-two"), "");  // which of them?
  EXPECT_FALSE(request.is_upgrade());
  EXPECT_FALSE(of("GET / HTTP/1.0\r\n").goes_on);
  EXPECT_FALSE(of("GET / HTTP/1.1\r\nConnection: Close\r\n").goes_on);
}

TEST(HttpRequest, UpgradesByItemsOfListsInAnyCase) {
  const std::string get = "GET / HTTP/1.1\r\n";
  EXPECT_TRUE(of(get + "Connection: keep-alive, UPGRADE\r\nUpgrade: WebSocket\r\n")
                  .is_upgrade());
  EXPECT_FALSE(of(get + "Connection: upgrades\r\nUpgrade: websocket\r\n").is_upgrade());
  EXPECT_FALSE(of(get + "Connection: upgrade,\r\nUpgrade: h2c\r\n").is_upgrade());
  EXPECT_FALSE(of("HEAD / HTTP/1.1\r\nConnection: upgrade\r\nUpgrade: websocket\r\n")
                   .is_upgrade());
}

TEST(HttpRequest, IsExactlyOfTheProtocolAndHasNoBody) {
  for (const char* const head :
       {"", "\r\n", "GET\r\n", "GET /\r\n", "GET  HTTP/1.1\r\n", "GET / HTTP/2\r\n",
        "GET / / HTTP/1.1\r\n", "G(T / HTTP/1.1\r\n", " / HTTP/1.1\r\n",
        "GET /\x7f HTTP/1.1\r\n"}) {
    EXPECT_FALSE(parse_http_request(head)) << head;
  }
  for (const char* const line :
       {"Host", ": a", "Host : a", " folded", "Ho st: a", "Host: a\rb", "Host: a\nb",
        "Content-Length: 9", "Content-Length: 00", "Transfer-Encoding: chunked"}) {
    EXPECT_FALSE(parse_http_request(std::string("GET / HTTP/1.1\r\n") + line + "\r\n"))
        << line;
  }
  const std::string zero = "GET / HTTP/1.1\r\nHost: a" + std::string(1, '\0') + "\r\n";
  EXPECT_FALSE(parse_http_request(zero));
  EXPECT_FALSE(parse_http_request("GET / HTTP/1.1\r\nHost: a"));  // is cut off
  EXPECT_TRUE(parse_http_request("POST / HTTP/1.1\r\nContent-Length: 0\r\n"));
}

}  // namespace
}  // namespace palpate
