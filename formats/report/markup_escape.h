// Text from files inside markup.
#pragma once

#include <string>

namespace palpate {

/// Text that HTML or SVG shows as it is: nothing of it is markup, and control
/// characters but line ends and tabs, which XML does not allow, become spaces; bytes
/// that are no UTF-8 become U+FFFD.
[[nodiscard]] std::string markup_escaped(const std::string& text);

}  // namespace palpate
