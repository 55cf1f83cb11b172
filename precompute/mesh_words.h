// Words and numbers of the text formats of meshes.
#pragma once

#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>

namespace palpate {

/// The next word of a line, and takes it away; empty at its end and before a comment
/// (#).
[[nodiscard]] std::string_view take_word(std::string_view& line);

/// Whether the whole word is a number; the value is set if it is.
template <typename Number>
[[nodiscard]] bool parse_number(std::string_view word, Number& value) {
  word.remove_prefix(word.starts_with('+') ? 1 : 0);
  const char* end = word.data() + word.size();
  const auto [after, error] = std::from_chars(word.data(), end, value);
  return error == std::errc() && after == end;
}

/// The text with LF at the end of every line and no byte order mark.
[[nodiscard]] std::string with_unix_lines(std::string bytes);

}  // namespace palpate
