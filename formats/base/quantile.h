// Quantiles of a few numbers, with one rounding for everything that is reported.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

namespace palpate {

/// The number of rank share * (n - 1), rounded to the nearest, halves upwards: of
/// eight, the fifth smallest is the median. 0 for none.
/// @param ascending sorted. @param share [0, 1].
[[nodiscard]] inline double quantile(std::span<const double> ascending,
                                     double share) noexcept {
  if (ascending.empty()) {
    return 0.0;
  }
  return ascending[static_cast<std::size_t>(
      std::lround(share * static_cast<double>(ascending.size() - 1)))];
}

}  // namespace palpate
