// Words and numbers of the text formats of meshes.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>

#include <Eigen/Core>

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

/// The three coordinates that a line begins with. @param vertex counted from 1, and the
/// line's number: named where it is wrong. @throws FormatError unless they are finite.
[[nodiscard]] Eigen::Vector3d read_point(std::string_view words, std::size_t vertex,
                                         int number);

/// The text with LF at the end of every line and no byte order mark.
[[nodiscard]] std::string with_unix_lines(std::string bytes);

}  // namespace palpate
