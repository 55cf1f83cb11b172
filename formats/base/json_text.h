// JSON as text, printed and parsed in one source: it takes seconds to compile wherever
// it is done.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace palpate {

/// As nlohmann::json::dump(); bytes that are no UTF-8 become U+FFFD. @param indent [-]
/// blanks of a level, a line for each value; below 0: all in one line.
[[nodiscard]] std::string json_text(const nlohmann::json& value, int indent = -1);
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& value,
                                    int indent = -1);

/// In one line, with \u for all that is not ASCII.
[[nodiscard]] std::string ascii_json_text(const nlohmann::ordered_json& value);

/// Discarded (is_discarded()) where the text is no JSON.
[[nodiscard]] nlohmann::json parse_json(std::string_view text);
[[nodiscard]] nlohmann::ordered_json parse_ordered_json(std::string_view text);

}  // namespace palpate
