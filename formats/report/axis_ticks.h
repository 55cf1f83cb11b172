// Round numbers for axes.
#pragma once

#include <string>
#include <vector>

namespace palpate {

/// The largest of 1, 2, 5 times a power of ten that is not above `value` (positive).
[[nodiscard]] double round_down(double value);

/// About `count` ticks at multiples of 1, 2 or 5 times a power of ten in [low, high],
/// low < high.
[[nodiscard]] std::vector<double> axis_ticks(double low, double high, int count);

/// A number to three digits without trailing zeros: "0.5", "12", "1.25".
[[nodiscard]] std::string short_number(double value);

}  // namespace palpate
