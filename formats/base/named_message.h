// Messages that name the file once, wherever they are handed on.
#pragma once

#include <string>
#include <string_view>

namespace palpate {

/// What a message says after the name of its file: "no numbers" of "a/b.csv: no
/// numbers" where the name is "b.csv", "a/b.csv" or "b.csv#2". A message that begins
/// with no such name is returned as it is.
[[nodiscard]] std::string_view without_name(std::string_view message,
                                            std::string_view name);

/// "name: message", with the name once.
[[nodiscard]] std::string with_name(std::string_view name, std::string_view message);

}  // namespace palpate
