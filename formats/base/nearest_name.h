// What a mistyped name may have meant.
#pragma once

#include <span>
#include <string_view>

namespace palpate {

/// The candidate with the smallest edit distance (insert, delete, replace and swap of
/// neighbours cost one each) to `name`; the first of equals; empty without candidates.
[[nodiscard]] std::string_view nearest_name(
    std::string_view name, std::span<const std::string_view> candidates);

}  // namespace palpate
