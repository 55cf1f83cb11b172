#include "formats/base/printable.h"

#include <fmt/format.h>

namespace palpate {
namespace {

unsigned byte_at(std::string_view text, std::size_t at) noexcept {
  return static_cast<unsigned char>(text[at]);
}

// C0 and C1, the latter as two bytes, and DEL.
bool is_control(std::string_view text, std::size_t at, std::size_t length) noexcept {
  const unsigned first = byte_at(text, at);
  if (length == 1) {
    return (first < 0x20 && first != '\n' && first != '\t') || first == 0x7F;
  }
  return length == 2 && first == 0xC2 && byte_at(text, at + 1) < 0xA0;
}

}  // namespace

std::size_t utf8_length(std::string_view text, std::size_t at) noexcept {
  const unsigned first = byte_at(text, at);
  if (first < 0x80) {
    return 1;
  }
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || at + length > text.size()) {
    return 0;
  }
  unsigned code = first & (0x7FU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    const unsigned next = byte_at(text, at + i);
    if ((next & 0xC0U) != 0x80U) {
      return 0;
    }
    code = code << 6U | (next & 0x3FU);
  }
  const bool overlong =
      (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  const bool surrogate = code >= 0xD800 && code < 0xE000;
  return overlong || surrogate || code > 0x10FFFF ? 0 : length;
}

std::string printable(std::string_view text) {
  std::string safe;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    if (length == 0 || is_control(text, at, length)) {
      const std::size_t bytes = length == 0 ? 1 : length;
      for (std::size_t i = 0; i < bytes; ++i) {
        safe += fmt::format("\\x{:02x}", byte_at(text, at + i));
      }
      at += bytes;
      continue;
    }
    safe += text.substr(at, length);
    at += length;
  }
  return safe;
}

}  // namespace palpate
