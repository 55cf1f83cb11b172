// Texts of one line each, as one text: how files keep lists of names.
#pragma once

#include <string>
#include <vector>

namespace palpate {

/// @param lines without line ends.
[[nodiscard]] std::string join_lines(const std::vector<std::string>& lines);

/// What was joined; nothing of an empty text.
[[nodiscard]] std::vector<std::string> split_lines(const std::string& text);

}  // namespace palpate
