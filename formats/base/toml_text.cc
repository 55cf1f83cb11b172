#include "formats/base/toml_text.h"

#include <algorithm>
#include <cstddef>
#include <string>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr int kKeyPartsMax = 64;

[[noreturn]] void not_toml(std::string_view name, std::size_t line,
                           std::string_view why) {
  throw InputError(fmt::format("{}:{}: is not TOML: {}", name, line, why));
}

// Where the quoted text that begins at `at` ends: one past its last quote.
std::size_t end_of_quoted(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const std::string thrice(3, quote);
  const bool several_lines = text.substr(at).starts_with(thrice);
  std::size_t i = at + (several_lines ? 3 : 1);
  while (i < text.size()) {
    if (several_lines ? text.substr(i).starts_with(thrice) : text[i] == quote) {
      return i + (several_lines ? 3 : 1);
    }
    if (!several_lines && text[i] == '\n') {
      return i;
    }
    i += quote == '"' && text[i] == '\\' ? 2 : 1;
  }
  return text.size();
}

// Parts of a key are words or quoted texts with dots between them, blanks allowed;
// anything else begins a new one. A number is a key of two parts here: no matter.
void require_short_keys(std::string_view text, std::string_view name) {
  std::size_t line = 1;
  int dots = 0;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    std::size_t next = i + 1;
    if (c == '#') {
      next = std::min(text.find('\n', i), text.size());
    } else if (c == '"' || c == '\'') {
      next = end_of_quoted(text, i);
    } else if (c == '.') {
      ++dots;
    } else if (std::string_view("=[]{},\n").find(c) != std::string_view::npos) {
      dots = 0;
    }
    if (dots >= kKeyPartsMax) {
      not_toml(name, line, fmt::format("a key has more than {} parts", kKeyPartsMax));
    }
    line += static_cast<std::size_t>(
        std::count(text.begin() + static_cast<std::ptrdiff_t>(i),
                   text.begin() + static_cast<std::ptrdiff_t>(next), '\n'));
    i = next;
  }
}

}  // namespace

toml::table parse_toml(std::string_view text, std::string_view name) {
  require_short_keys(text, name);
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    not_toml(name, error.source().begin.line, error.description());
  }
}

}  // namespace palpate
