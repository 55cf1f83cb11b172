// What is before contact, as it is: a straight line and white noise. Or what is before
// contact is interference, vibration, a sensor's steps, a bent drift, a toe of the
// curve.
#pragma once

#include <array>
#include <optional>

#include "fitting/curve/measured_approach.h"
#include "fitting/curve/power_law_fit.h"

namespace palpate {

/// Whether the law surely misses the curve, or what the law takes for free travel is no
/// straight line. On a toe of the curve the noise of all is no yardstick.
/// @param fit of the approach, no empty run, as for all functions here.
[[nodiscard]] bool is_led_astray(const Approach& approach, const ContactFit& fit);

/// Makes the noise of what is surely free the yardstick of what the law misses (misfit,
/// free_to_m), where that noise explains the miss. The miss is then not the law's
/// fault. Surely free is what somebody has stated, or the first half of what the law
/// takes for free travel.
/// @return false where the noise does not explain the miss, or is more than 2 % of the
/// forces' range. False, too, for fewer than 40 samples, or where the noise grows with
/// the force.
[[nodiscard]] bool explain_by_free_travel(const Approach& approach, ContactFit& fit);

/// The bend of the drift before contact, a parabola's, which leaves nothing but noise
/// there and is at most 2 % of the forces' range.
struct DriftBend {
  /// The approach without the bend: as if the parabola went on, and as if it ended
  /// where contact begins and the drift went on straight.
  std::array<Approach, 2> straight;
  double deviations = 0.0;  ///< [-] > 1 its size over its standard deviation
  /// [-] (0, 1] of the samples: as many of white noise would tell the bend as well
  double independent = 1.0;

  /// 4 standard deviations.
  [[nodiscard]] bool is_sure() const;
};

/// @return none where the bend is within its standard deviation.
[[nodiscard]] std::optional<DriftBend> bend_of_drift(const Approach& approach,
                                                     const ContactFit& fit);

/// The standard deviation of a result because of a bend that may not be there. Each way
/// of straightening moves the result. The squares are averaged by each way's Akaike
/// weight (Burnham & Anderson 2002, 2.9), a bend being as likely as none before. Of the
/// bend's square counts what exceeds its own variance.
/// @param fit of the approach with its bend
/// @param straight fits of bend.straight, by the same law
/// @param moved the results of these less that of `fit`
[[nodiscard]] double bend_sd(const DriftBend& bend, const ContactFit& fit,
                             const std::array<ContactFit, 2>& straight,
                             const std::array<double, 2>& moved);

/// [m] The end of the first sixth of the travel, or of a half, a quarter or an eighth
/// of that sixth. The force is flat until there. No fit is needed to see that contact
/// is not before.
[[nodiscard]] std::optional<double> flat_until_m(const Approach& approach);

/// The samples up to the first peak with a fall behind it. The fall is of 10 standard
/// deviations of noise and a tenth of what the force had risen. None where the force
/// never falls so, or the peak is within the first 16 samples.
[[nodiscard]] std::optional<Approach> before_fall(const Approach& approach);

}  // namespace palpate
