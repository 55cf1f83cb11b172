// Estimates of size and noise that single wild readings cannot move; and the plain
// ones.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace palpate {

/// Standard deviations on either side of the mean that hold 95 % of a normal
/// distribution.
inline constexpr double kNormal95 = 1.959964;

/// Largest minus smallest of at least one value.
[[nodiscard]] double extent(const std::vector<double>& values);

/// Root mean square. NaN for no values.
[[nodiscard]] double rms(const std::vector<double>& values);

/// Middle value, mean of the two middle ones for an even count. NaN for no values.
[[nodiscard]] double median(std::vector<double> values);

/// 1.4826 times the median distance from the median: the standard deviation, if the
/// values are normal. NaN for no values.
[[nodiscard]] double robust_standard_deviation(const std::vector<double>& values);

/// Standard deviation of white noise on a smooth curve, from second differences
/// f[i-1] - 2 f[i] + f[i+1], whose variance is 6 times that of the noise. 0 for fewer
/// than 3 values.
[[nodiscard]] double noise_standard_deviation(std::span<const double> values);

/// Standard deviations that make a usual limit of without_outliers().
inline constexpr double kOutlierDeviations = 5.0;

/// Indices of the residuals that are no outliers. Such residuals are within `limit`, or
/// in a run of more than three beyond it on one side, which is a shape and no glitch.
/// All, where more than one of 20 were outliers: then the law fails, not the samples.
[[nodiscard]] std::vector<std::size_t> without_outliers(
    std::span<const double> residuals, double limit);

/// Each value replaced by the median of itself and up to `reach` neighbours on both
/// sides. As many are taken on one side as on the other, so a rising sequence stays as
/// it is.
[[nodiscard]] std::vector<double> running_median(std::span<const double> values,
                                                 std::size_t reach);

}  // namespace palpate
