// Joint fit of a needle's passes: curve before rupture, ruptures, cutting forces,
// friction of the shaft (needle_model.h).
//
// All passes are fitted together by least squares; ruptures and the end of sticking lie
// between samples. Intervals are under the noise of the residuals
// (covariance_under_noise), with the distance of neighbouring samples where an event
// lies between them. A rupture whose fall is not beyond the noise at kFalseFallRate in
// the joint fit is dropped.
#pragma once

#include <string>
#include <vector>

#include "fitting/insertion/needle_events.h"
#include "fitting/numerics/interval_estimate.h"

namespace palpate {

struct FittedRupture {
  int pass = 0;
  double measured_m = 0.0;      ///< [m] depth of the needle in the file
  IntervalEstimate depth_m;     ///< [m] the same below the contact point
  IntervalEstimate boundary_m;  ///< [m] of the membrane below the surface at rest
  IntervalEstimate force_n;     ///< [N] of the tip at the rupture
  double fall_n = 0.0;          ///< [N] sudden fall of the force
  double deviations = 0.0;      ///< [-] fall over its standard deviation
};

/// Of the tissue behind a rupture.
struct FittedLayer {
  IntervalEstimate cutting_n;         ///< [N]
  IntervalEstimate friction_n_per_m;  ///< [N/m] per inserted length
  IntervalEstimate start_n;  ///< [N] cutting force and friction where the layer begins
  IntervalEstimate slope_n_per_m;  ///< [N/m] of the force within the layer
};

struct NeedleBaseline {
  double offset_n = 0.0;
  IntervalEstimate drift_n;  ///< [N] over the file
};

struct NeedleFit {
  IntervalEstimate coefficient, exponent, contact_m;  ///< [N/m^n], [-], [m]
  std::vector<FittedRupture> ruptures;                ///< at least one
  std::vector<FittedLayer> layers;                    ///< one of each rupture
  IntervalEstimate static_ratio;                      ///< [-] rho
  IntervalEstimate presliding_n_per_m;                ///< [N/m] k_b
  std::vector<NeedleBaseline> baselines;              ///< (files)
  double rms_n = 0.0;                                 ///< [N] of the residuals
  double free_rms_n = 0.0;  ///< [N] of those before contact; NaN: too few
  bool misses = false;      ///< residuals in the tissue are beyond the noise before it
  bool converged = false;
  std::size_t samples = 0;         ///< fitted
  std::size_t dropped = 0;         ///< falls that the joint fit did not confirm
  std::vector<std::string> notes;  ///< what cannot be separated, a sentence each
};

/// @throws InputError where no force falls suddenly (no puncture), and as
/// find_ruptures() and start_curve().
[[nodiscard]] NeedleFit fit_needle(const NeedlePath& path);

}  // namespace palpate
