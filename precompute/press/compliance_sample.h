// The columns of a shared surface compliance that a few presses need: a sample from
// which the cost of all columns is estimated.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "precompute/press/node_press.h"

namespace palpate {

struct ColumnSample {
  std::vector<char> wanted;  ///< by contact node, as SurfaceCompliance has it
  std::size_t all = 0;       ///< columns that all placed nodes need
  std::size_t solved = 0;    ///< columns that are solved for the wanted ones, by blocks
};

/// @param placed every node that a build presses. @param vertices of the sample,
/// ascending.
[[nodiscard]] ColumnSample column_sample(const BodyModel& model,
                                         std::span<const PressedNode> placed,
                                         std::span<const std::int32_t> vertices);

/// `count` of the vertices, evenly spread over their order.
[[nodiscard]] std::vector<std::int32_t> spread_over(
    std::span<const std::int32_t> vertices, std::size_t count);

}  // namespace palpate
