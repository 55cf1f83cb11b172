// Text that came from a file, shown to people.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace palpate {

/// Bytes of the UTF-8 character at `at`; 0 where no character begins. No character
/// begins at a stray byte, one that is cut short, an overlong form, a surrogate or more
/// than U+10FFFF.
[[nodiscard]] std::size_t utf8_length(std::string_view text, std::size_t at) noexcept;

/// The text for a terminal: control characters but line ends and tabs (a terminal would
/// obey them) and bytes that are no UTF-8 as \xNN.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace palpate
