// A specimen that sticks to the tool: pulls it before contact, and holds it back after.
//
// A force law that only pushes takes the jump into contact for noise and puts the
// contact point too deep. Whether there is adhesion is decided by forces below the
// baseline: at the end of the retract (pull-off) and before the force rises (snap-in).
//
// A sphere has radius R and work of adhesion W. The pull-off force is 3/2 pi W R where
// the specimen is soft and the sphere large (Johnson, Kendall and Roberts 1971). The
// force is 2 pi W R where the specimen is hard and the sphere small (Derjaguin, Muller
// and Toporov 1975).
#pragma once

#include <limits>

#include "fitting/curve/free_samples.h"

namespace palpate {

struct Adhesion {
  double pull_off_n = 0.0;  ///< [N] deepest below the baseline during the retract, >= 0
  double snap_in_n = 0.0;   ///< [N] the same during the approach
  double noise_n = std::numeric_limits<double>::quiet_NaN();
  ///< [N] standard deviation of the free samples' force about the baseline; NaN: no
  ///< free samples, nothing is reported
  double zero_n = 0.0, slope_n_per_m = 0.0;  ///< baseline before contact, signs turned
  bool pulls_off = false;  ///< the pull-off is beyond kAdhesionDeviations of noise
  bool snaps_in = false;

  [[nodiscard]] bool seen() const { return pulls_off || snaps_in; }
};

constexpr double kAdhesionDeviations = 6.0;

/// Readings are medians of three neighbours, so that a single wild one is no adhesion.
/// The baseline is of the first two thirds of the free samples before contact. The
/// baseline has these samples' median, and a slope with displacement where the slope is
/// beyond 4 of its standard deviations. For the pull-off the baseline is lowered to the
/// median after the retract where that median is less. So a sensor that does not come
/// back to its zero is no adhesion. Nothing is stated with fewer than 10 free samples
/// before contact.
/// @param samples as the machine gave them, a drift with time taken off.
[[nodiscard]] Adhesion find_adhesion(const Measurement& samples,
                                     const Approach& approach, const ContactFit& fit);

/// Work of adhesion W [J/m^2] of a sphere of radius R [m] from its pull-off force [N].
[[nodiscard]] double jkr_work_of_adhesion(double pull_off_n, double radius_m);
[[nodiscard]] double dmt_work_of_adhesion(double pull_off_n, double radius_m);

}  // namespace palpate
