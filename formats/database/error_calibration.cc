#include "formats/database/error_calibration.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate {

ErrorCalibration calibrate_errors(std::span<const double> estimate,
                                  std::span<const double> error) {
  ErrorCalibration calibration;
  calibration.checks = std::ssize(error);
  if (error.empty()) {
    return calibration;
  }
  std::vector<double> ratio(error.size());
  for (std::size_t i = 0; i < error.size(); ++i) {
    ratio[i] = error[i] / estimate[i];
  }
  std::sort(ratio.begin(), ratio.end());
  if (calibration.checks < kChecksToCalibrate) {
    calibration.factor = std::max(kUncheckedFactor, ratio.back());
    return calibration;
  }
  const double rank = std::ceil(kErrorCoverage * static_cast<double>(ratio.size() + 1));
  calibration.factor = ratio[static_cast<std::size_t>(rank) - 1];
  return calibration;
}

}  // namespace palpate
