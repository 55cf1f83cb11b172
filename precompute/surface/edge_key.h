// Edges as keys of maps.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace palpate {

/// The same for both directions of an edge between two vertices, from 0 on; ascends
/// with the lower one, then the higher.
[[nodiscard]] inline std::uint64_t edge_key(const std::array<std::int32_t, 2>& edge) {
  const auto [low, high] = std::minmax(edge[0], edge[1]);
  return (static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint32_t>(high);
}

}  // namespace palpate
