// What a mistyped name may have meant.
#pragma once

#include <span>
#include <string_view>

namespace palpate {

/// The candidate with the smallest edit distance to `name`. Insert, delete, replace and
/// swap of neighbours cost one each. Of equals the first is taken; without candidates
/// the result is empty.
[[nodiscard]] std::string_view nearest_name(
    std::string_view name, std::span<const std::string_view> candidates);

}  // namespace palpate
