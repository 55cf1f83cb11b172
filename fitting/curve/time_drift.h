// A force sensor that drifts with time, as temperature makes it.
//
//   F = b0 + b1 x + c t    while the tool touches nothing
//
// Symbols: F force [N], x displacement [m], t time [s]. A drift with time and one with
// displacement are separated by free samples before contact and after the retract. A
// dwell before the approach tells them apart, too. The baseline of the force law (b0 +
// b1 x) cannot take in c t. The retract's part would be counted as loss, and holds as
// relaxation.
#pragma once

#include <limits>
#include <string>

#include "fitting/curve/free_samples.h"

namespace palpate {

struct TimeDrift {
  std::string refused;  ///< why it is not known; empty where it is
  double n_per_s = std::numeric_limits<double>::quiet_NaN();  ///< [N/s] c, signs turned
  double sd_n_per_s = std::numeric_limits<double>::quiet_NaN();
  double seconds = 0.0;      ///< [s] that the measurement took
  bool significant = false;  ///< c is beyond kDriftDeviations standard deviations
  bool leaps = false;        ///< refused since the baseline leaps
  std::size_t samples = 0;   ///< free ones
};

constexpr double kDriftDeviations = 4.0;

/// Refused without time, with fewer than 10 free samples, and where displacement and
/// time cannot be separated. Refused where the baseline leaps between approach and
/// retract. A leap is more than kDriftDeviations standard deviations from what a steady
/// drift explains.
[[nodiscard]] TimeDrift find_time_drift(const Measurement& measurement,
                                        const Approach& approach,
                                        const ContactFit& fit);

/// Takes a significant drift off the force, counted from the first sample.
/// @param measurement with its own signs.
void take_off_drift(const TimeDrift& drift, const Approach& approach,
                    Measurement& measurement);

}  // namespace palpate
