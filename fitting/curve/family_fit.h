// One family fitted to one approach, and the choice among several.
//
//   F(x) = b0 + b1 x + f(x - x0; q)
//
// The contact point x0 is fitted with families whose start has a shape of its own.
// Families that could follow any x0 (splines and the polynomial's slope) take the power
// law's. None is before the approach's contact_from_m.
//
// Families that miss the data by more than their noise (misfit.h) come after all that
// do not, whatever a criterion says. Such families are in the order of their residuals.
// Interpolating, which may fall, comes after all others that do not miss, unless its
// AICc is better than all of theirs by 30.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fitting/curve/curve_family.h"
#include "fitting/curve/curve_feature.h"
#include "fitting/curve/misfit.h"
#include "fitting/curve/power_law_fit.h"

namespace palpate {

struct FamilyFitOptions {
  bool cross_validate = true;
};

struct FamilyFit {
  std::string family;
  std::vector<FitParameter> parameters;  ///< b0, b1, x0, then the family's; SI units
  double contact_point_m = std::numeric_limits<double>::quiet_NaN();
  double contact_point_sd_m = std::numeric_limits<double>::quiet_NaN();
  double depth_max_m = 0.0;  ///< [m] largest displacement beyond the contact point
  double rms_n = 0.0;        ///< [N] of the residuals of the samples used
  double cross_rms_n = 0.0;  ///< [N] of blocks that the fit had not seen; NaN: not done
  Misfit misfit;             ///< [N] by the noise of the family that misses least
  bool misses = false;       ///< misfit.h, matters()
  double deviance = 0.0;     ///< [-] by that noise, misfit.h
  double aicc = 0.0;  ///< [-] deviance + 2 k n / (n - k - 1); +inf: too few samples
  double bic = 0.0;   ///< [-] deviance + k log n
  int free_parameters = 0;
  bool converged = false;
  int iterations = 0;
  std::vector<std::string> at_bound;  ///< names of parameters that stand at a bound

  // How to evaluate it: scaled parameters b0, b1, x0, q and their covariance.
  std::shared_ptr<const CurveFamily> curve;
  Eigen::VectorXd scaled;
  Eigen::MatrixXd covariance;
  double x_origin_m = 0.0, length_m = 1.0, force_n = 1.0;
};

/// The families fitted to the same samples, best first by the criterion.
struct FamilyChoice {
  std::vector<FamilyFit> fits;                  ///< empty for an empty run
  std::vector<double> displacement_m, force_n;  ///< (n) the samples used
  std::size_t outliers = 0;
  double noise_sd_n = 0.0;             ///< [N] of these samples, white and shared
  double independent_samples = 0;      ///< that tell as much of a mean
  std::vector<CurveFeature> features;  ///< of the first family's curve
  std::string criterion;
};

/// @param reference the power law's fit of the same approach, exponent free. The power
/// law is the first family, and gives baseline and contact point of families without
/// one of their own. If the law misses, these are of the law of as much of the curve's
/// beginning as the law does not miss.
/// @param criterion one of kCriteria (session.h).
/// @throws InputError for an unknown family.
[[nodiscard]] FamilyChoice fit_families(const Approach& approach,
                                        const ContactFit& reference,
                                        const std::vector<std::string>& families,
                                        const std::string& criterion,
                                        const FamilyFitOptions& options = {});

/// Force [N], slope [N/m] and energy [J] at depth d [m] beyond the contact point.
[[nodiscard]] FamilyPoint family_point(const FamilyFit& fit, double depth_m);

/// Baseline and curve at displacement x [m], as the residuals see it [N].
[[nodiscard]] double fitted_force_n(const FamilyFit& fit, double displacement_m);

/// Standard deviation [N] of fitted_force_n() from the parameters' covariance; NaN
/// where that is not known.
[[nodiscard]] double fitted_sd_n(const FamilyFit& fit, double displacement_m);

}  // namespace palpate
