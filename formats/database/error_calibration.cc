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

double calibrate_errors(std::span<const double> estimate,
                        std::span<const double> error) {
  std::vector<double> ratio(error.size());
  for (std::size_t i = 0; i < error.size(); ++i) {
    ratio[i] = error[i] / estimate[i];
  }
  return ratio.empty() ? kLeastErrorFactor
                       : std::max(kLeastErrorFactor, covering(std::move(ratio)));
}

}  // namespace palpate
