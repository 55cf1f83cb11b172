#include "formats/database/error_calibration.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace palpate {

double covering(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const double rank =
      std::ceil(kErrorCoverage * static_cast<double>(values.size() + 1));
  return values[std::min(static_cast<std::size_t>(rank), values.size()) - 1];
}

double covered_share(std::size_t known, std::size_t n) {
  const auto share = static_cast<double>(known) / static_cast<double>(n + 1);
  return std::min(kErrorCoverage, share);
}

double calibrate_errors(std::span<const double> estimate,
                        std::span<const double> error) {
  std::vector<double> ratio(error.size());
  for (std::size_t i = 0; i < error.size(); ++i) {
    ratio[i] = error[i] / estimate[i];
  }
  if (ratio.empty()) {
    return kLeastErrorFactor;
  }
  double factor = covering(ratio);
  if (std::isinf(factor)) {
    factor = 0.0;
    for (const double known : ratio) {
      factor = std::isinf(known) ? factor : std::max(factor, known);
    }
  }
  return std::max(kLeastErrorFactor, factor);
}

}  // namespace palpate
