#include "formats/database/error_calibration.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate {

double calibrate_errors(std::span<const double> estimate,
                        std::span<const double> error) {
  std::vector<double> ratio(error.size());
  for (std::size_t i = 0; i < error.size(); ++i) {
    ratio[i] = error[i] / estimate[i];
  }
  std::sort(ratio.begin(), ratio.end());
  if (ratio.empty()) {
    return kLeastErrorFactor;
  }
  const double rank = std::ceil(kErrorCoverage * static_cast<double>(ratio.size() + 1));
  const std::size_t at = std::min(static_cast<std::size_t>(rank), ratio.size()) - 1;
  return std::max(kLeastErrorFactor, ratio[at]);
}

}  // namespace palpate
