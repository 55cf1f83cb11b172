// The clock of samples in a row, for what drifts with time.
#pragma once

#include <cstddef>
#include <vector>

namespace palpate {

/// (n) 0 to 1: time where it rises from the first to the last sample, else the number
/// of the sample. @param time_s (n), or empty. @param n at least 2.
[[nodiscard]] std::vector<double> sample_clock(const std::vector<double>& time_s,
                                               std::size_t n);

}  // namespace palpate
