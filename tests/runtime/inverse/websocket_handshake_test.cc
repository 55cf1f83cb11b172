// Heads of HTTP messages, taken whole or not at all, and the standard's key.
#include "runtime/inverse/websocket_handshake.h"

#include <string>

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(WebsocketHandshake, AnswersTheStandardsKey) {  // RFC 6455, section 1.3
  EXPECT_EQ(websocket_accept("dGhlIHNhbXBsZSBub25jZQ=="),
            "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
  EXPECT_EQ(websocket_key().size(), 24U);
  EXPECT_NE(websocket_key(), websocket_key());
}

TEST(WebsocketHandshake, TakesAHeadOnceItIsWhole) {
  const std::string text =
      "GET / HTTP/1.1\r\nHost: a:1\r\nUPGRADE:\t WebSocket \r\nhost: "
      "b\r\nNone:\r\n\r\n";
  for (std::size_t size = 0; size < text.size(); ++size) {
    std::string bytes = text.substr(0, size);
    ASSERT_FALSE(take_http_head(bytes));
    ASSERT_EQ(bytes.size(), size);
  }
  std::string bytes = text + "more\r\n\r\n";
  const std::string head = take_http_head(bytes).value();
  EXPECT_EQ(bytes, "more\r\n\r\n");
  EXPECT_EQ(head, text.substr(0, text.size() - 2));
  EXPECT_EQ(http_field(head, "host"), "a:1");
  EXPECT_EQ(http_field(head, "upgrade"), "WebSocket");
  EXPECT_EQ(http_field(head, "none"), "");
  EXPECT_EQ(http_field(head, "other"), "");
  EXPECT_EQ(http_field(head, "get / http/1.1"), "");
  EXPECT_EQ(lower_case("WebSocket"), "websocket");
}

}  // namespace
}  // namespace palpate
