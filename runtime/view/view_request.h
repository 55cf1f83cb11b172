// Heads of requests by HTTP/1.1 (RFC 9112) from whoever can reach the port. What is not
// exactly one of them, or announces a body, is none.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate {

struct HttpRequest {
  std::string method{};
  std::string target{};
  bool goes_on = false;  ///< whether another may come by the same connection
  std::vector<std::pair<std::string, std::string>> fields{};  ///< names in lower case

  /// The field of that name; empty where there is none, or more than one.
  [[nodiscard]] std::string_view only(std::string_view name) const;

  /// Whether a field of that name lists `item`, in letters of any case.
  [[nodiscard]] bool lists(std::string_view name, std::string_view item) const;

  /// Whether it asks for a WebSocket.
  [[nodiscard]] bool is_upgrade() const;
};

/// @param head all lines with their ends, without the empty one. Null: not a request.
[[nodiscard]] std::optional<HttpRequest> parse_http_request(std::string_view head);

}  // namespace palpate
