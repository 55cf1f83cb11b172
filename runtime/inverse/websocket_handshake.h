// How a WebSocket begins (RFC 6455, section 4): heads of HTTP/1.1 messages, and the key
// that is answered.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace palpate {

constexpr std::size_t kHttpHeadBytes = 16384;  ///< longest that ends look at

/// Takes a head, all lines with their ends, off the beginning of `bytes`; null while it
/// is not whole.
[[nodiscard]] std::optional<std::string> take_http_head(std::string& bytes);

/// The first field of that name, which is in lower case; empty where there is none.
[[nodiscard]] std::string http_field(const std::string& head, const std::string& name);

[[nodiscard]] std::string lower_case(std::string text);

/// A key for one connection, of 16 random bytes, and what answers a key.
[[nodiscard]] std::string websocket_key();
[[nodiscard]] std::string websocket_accept(const std::string& key);

}  // namespace palpate
