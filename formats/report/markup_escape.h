// Text from files inside markup.
#pragma once

#include <string>

namespace palpate {

/// Text that HTML or SVG shows as it is: nothing of the text is markup. Control
/// characters but line ends and tabs become spaces, because XML does not allow them.
/// Bytes that are no UTF-8 become U+FFFD.
[[nodiscard]] std::string markup_escaped(const std::string& text);

}  // namespace palpate
