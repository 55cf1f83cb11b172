#include "fitting/numerics/robust_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace palpate {
namespace {

constexpr std::size_t kGlitchMax = 3, kOutliersOneOf = 20;
constexpr double kNormalMad = 1.4826;  // standard deviation over median deviation

}  // namespace

double extent(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

double rms(const std::vector<double>& values) {
  double squares = 0.0;
  for (const double value : values) {
    squares += value * value;
  }
  return std::sqrt(squares / static_cast<double>(values.size()));
}

double median(std::vector<double> values) {
  if (values.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) {
    return *middle;
  }
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

double robust_standard_deviation(const std::vector<double>& values) {
  const double centre = median(values);
  std::vector<double> distance(values.size());
  std::transform(values.begin(), values.end(), distance.begin(), [&](double value) {
    return std::abs(value - centre);
  });
  return kNormalMad * median(std::move(distance));
}

double noise_standard_deviation(std::span<const double> values) {
  if (values.size() < 3) {
    return 0.0;
  }
  // Second differences of white noise have 1 + 4 + 1 = 6 times its variance.
  std::vector<double> difference;
  difference.reserve(values.size());
  for (std::size_t i = 1; i + 1 < values.size(); ++i) {
    difference.push_back(std::abs(values[i - 1] - 2.0 * values[i] + values[i + 1]));
  }
  return kNormalMad * median(std::move(difference)) / std::sqrt(6.0);
}

std::vector<std::size_t> without_outliers(std::span<const double> residuals,
                                          double limit) {
  const std::size_t n = residuals.size();
  const auto side = [&](std::size_t i) {
    return residuals[i] > limit ? 1 : residuals[i] < -limit ? -1 : 0;
  };
  // Runs beyond the limit on one side are outliers if they are short: longer ones are
  // what the law misses.
  std::vector<std::size_t> kept;
  for (std::size_t begin = 0, end = 0; begin < n; begin = end) {
    while (end < n && side(end) == side(begin)) {
      ++end;
    }
    for (std::size_t i = begin;
         i < end && (side(begin) == 0 || end - begin > kGlitchMax); ++i) {
      kept.push_back(i);
    }
  }
  // Where more than one of twenty would go, none does.
  if (kept.size() * kOutliersOneOf < n * (kOutliersOneOf - 1)) {
    kept.resize(n);
    std::iota(kept.begin(), kept.end(), std::size_t{0});
  }
  return kept;
}

std::vector<double> running_median(std::span<const double> values, std::size_t reach) {
  std::vector<double> result(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t side = std::min({reach, i, values.size() - 1 - i});
    const auto window = values.subspan(i - side, 2 * side + 1);
    result[i] = median({window.begin(), window.end()});
  }
  return result;
}

}  // namespace palpate
