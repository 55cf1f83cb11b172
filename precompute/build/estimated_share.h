// How many of many values pass a limit, estimated from a few of them.
#pragma once

#include <span>

namespace palpate {

/// Share [0, 1] of all values above a limit > 0, if their logarithms are normally
/// distributed with the mean and deviation of these. Values that are not positive do
/// not count; fewer than two give 0.
[[nodiscard]] double share_above(std::span<const double> values, double limit);

}  // namespace palpate
