// Whom the live view's server trusts: tokens, rates and the content policy, free of the
// network.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace palpate {

/// 128 random bits of the kernel as 32 hexadecimal digits. @throws DeviceError if it
/// has none.
[[nodiscard]] std::string random_token();

/// Equal, in a time that does not tell how many digits were right.
[[nodiscard]] bool same_token(std::string_view a, std::string_view b) noexcept;

/// A page asks for the WebSocket protocols "palpate.1, TOKEN": a browser lets it say no
/// more.
inline constexpr std::string_view kViewProtocol = "palpate.1";
[[nodiscard]] bool brings_token(std::string_view protocols,
                                std::string_view token) noexcept;

/// The Content-Security-Policy of a page from host, "127.0.0.1:8080": its own scripts
/// and styles, its own socket, pictures that it makes; nothing inline, nothing else.
[[nodiscard]] std::string content_policy(const std::string& host);

/// A client's allowance of messages: fills with time, up to a second's worth.
class MessageRate {
 public:
  /// @param per_s [1/s] > 0.
  explicit MessageRate(double per_s) : per_s_(per_s), left_(per_s) {}

  /// Counts a message; false if it was one too many.
  [[nodiscard]] bool allow(std::chrono::steady_clock::time_point now);

 private:
  double per_s_;
  double left_;
  std::chrono::steady_clock::time_point before_ = std::chrono::steady_clock::now();
};

}  // namespace palpate
