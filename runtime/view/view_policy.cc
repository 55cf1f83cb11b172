#include "runtime/view/view_policy.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <sys/random.h>

#include "formats/base/error.h"

namespace palpate {

std::string random_token() {
  std::array<unsigned char, 16> bits{};
  if (getrandom(bits.data(), bits.size(), 0) != static_cast<ssize_t>(bits.size())) {
    throw DeviceError("the kernel has no random bits for the page's token");
  }
  std::string token;
  for (const unsigned char byte : bits) {
    token += fmt::format("{:02x}", byte);
  }
  return token;
}

bool same_token(std::string_view a, std::string_view b) noexcept {
  unsigned difference = a.size() == b.size() ? 0U : 1U;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    difference |= static_cast<unsigned char>(a[i] ^ b[i]);
  }
  return difference == 0U;
}

bool brings_token(std::string_view protocols, std::string_view token) noexcept {
  const std::size_t comma = protocols.find(',');
  if (comma == std::string_view::npos || protocols.substr(0, comma) != kViewProtocol) {
    return false;
  }
  protocols.remove_prefix(comma + 1);
  protocols.remove_prefix(protocols.starts_with(' ') ? 1 : 0);
  return same_token(protocols, token);
}

std::string content_policy(const std::string& host) {
  return fmt::format(
      "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: "
      "blob:; media-src blob:; connect-src 'self' ws://{}; base-uri 'none'; "
      "form-action 'none'; frame-ancestors 'none'",
      host);
}

bool MessageRate::allow(std::chrono::steady_clock::time_point now) {
  left_ += per_s_ * std::chrono::duration<double>(now - before_).count();
  left_ = std::min(left_, per_s_) - 1.0;
  before_ = now;
  return left_ >= 0.0;
}

}  // namespace palpate
