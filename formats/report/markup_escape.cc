#include "formats/report/markup_escape.h"

#include <cstddef>

#include "formats/base/printable.h"

namespace palpate {

std::string markup_escaped(const std::string& text) {
  std::string safe;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    const char c = text[at];
    if (length == 0) {
      safe += "\xEF\xBF\xBD";  // U+FFFD: XML of anything else is none
      ++at;
      continue;
    }
    switch (c) {
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '&':
        safe += "&amp;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\n':
      case '\t':
        safe += c;
        break;
      default:
        safe += static_cast<unsigned char>(c) < 0x20 ? " " : text.substr(at, length);
    }
    at += length;
  }
  return safe;
}

}  // namespace palpate
