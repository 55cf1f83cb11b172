// Contact point and force law of one measured approach, found together.
//
//   F(x) = b0 + b1 x + K max(x - x0, 0)^p
//
// Symbols: x displacement [m], F force [N], b0 + b1 x baseline and drift [N], [N/m], x0
// contact point [m], p exponent [-], K coefficient [N/m^p]. Detectors that wait for the
// force to rise are late (by 0.2 to 1 mm over 5 mm). The joint fit is unbiased as long
// as p is free.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "fitting/curve/fit_flag.h"
#include "fitting/curve/measured_approach.h"
#include "fitting/curve/misfit.h"

namespace palpate {

/// [-] of the depth: a contact point less sure than that is not identified.
constexpr double kContactSdShareMax = 0.1;

struct FitParameter {
  std::string name;
  double value = 0.0;
  std::string unit;                                      ///< empty for a pure number
  double sd = std::numeric_limits<double>::quiet_NaN();  ///< NaN: held or unknown
  std::string held;  ///< why it was not free: "given", "assumed", "lower bound", ...
};

/// Where contact begins, as far as the samples tell. NaN: unknown.
struct ContactPoint {
  double m = std::numeric_limits<double>::quiet_NaN();
  double sd_m = std::numeric_limits<double>::quiet_NaN();
};

struct ContactFit {
  std::string family;  ///< "power_law"; "none" for an empty run, nothing fitted then
  std::vector<FitParameter> parameters;
  double contact_point_m = std::numeric_limits<double>::quiet_NaN();  ///< the law's own
  double contact_point_sd_m = std::numeric_limits<double>::quiet_NaN();
  ContactPoint contact;  ///< that of `beginning` where there is one, else the law's
  double exponent = std::numeric_limits<double>::quiet_NaN();     ///< [-] p
  double coefficient = std::numeric_limits<double>::quiet_NaN();  ///< [N/m^p] K
  double coefficient_sd = std::numeric_limits<double>::quiet_NaN();
  double depth_max_m = 0.0;  ///< [m] largest displacement beyond the contact point
  double rms_n = 0.0;        ///< [N] of the weighed residuals of the samples used
  Misfit misfit;             ///< [N] what of them is noise, and what is not
  /// [N/m] of the line through those in contact; NaN: fewer than two
  double mean_stiffness_n_per_m = 0.0;
  /// [m] what precedes it tells the noise by which `misfit` is judged (free_travel.h);
  /// NaN: the residuals' own
  double free_to_m = std::numeric_limits<double>::quiet_NaN();
  std::size_t samples_used = 0;
  std::size_t outliers = 0;    ///< beyond 5 robust standard deviations; left out
  std::vector<FitFlag> flags;  ///< the approach's first
  bool converged = false;
  int iterations = 0;  ///< of all starts
  /// (5 x 5) of the parameters in their units, rows of held ones zero; NaN: unknown
  Eigen::MatrixXd covariance;
  double seconds = 0.0;         ///< [s] wall time
  double noise_relative = 0.0;  ///< [-] as given
  /// Where the law surely misses the curve: the same law for as much of its beginning
  /// as the law does not miss. The beginning is up to 40, 15 or 5 % of the force; null
  /// where the law misses all
  std::shared_ptr<const ContactFit> beginning;

  [[nodiscard]] bool has(FitFlag flag) const;
};

struct ContactFitOptions {
  std::optional<double> exponent = {};  ///< [-] [1, 4] held; free without
  double noise_relative = 0.0;  ///< [-] [0, 1) part of the noise that grows with force
};

/// Least squares from several starts with a robust loss, then without loss on the
/// inliers. Standard deviations follow from the residuals' own noise, white or
/// correlated among neighbours.
///
/// 1. Bounds. A parameter at a bound is held there and named.
/// 2. Drift. Drift is expected to lift the force by at most a tenth of its range (one
///    standard deviation). The expectation matters where the free travel is short.
///    Where the free travel is too short to separate drift from contact, the fit has no
///    drift, if that fits as well.
/// 3. No free travel. The contact point is among the first samples, or the drift lifts
///    the force by more than a tenth of its range before contact. Then the contact
///    point is assumed at the first sample, the drift is zero, and a flag says so. An
///    approach that is known to be free at first (contact_from_m) is excepted. Its
///    contact point is not before that, and its drift is always fitted.
/// 4. Lack of fit: the law surely misses the curve (misfit.h). Then no drift lifts the
///    force by more than that tenth, however uncertain the drift is. Contact is not
///    assumed at the first sample where the curve's beginning has free travel.
/// 5. Beginning. With lack of fit and a free exponent, `contact` is that of the longest
///    beginning that the law follows. Beginnings have 0.4, 0.15 or 0.05 of the force.
///    The contact point's standard deviation includes the largest difference to the
///    contact points of the whole curve and of the next longer and shorter beginning.
///    Where the law follows no beginning, the contact point of what precedes the first
///    fall of the force counts; without one `contact` is not identified.
/// 6. Exceptions. The law does not miss what the noise before contact explains, nor
///    what a sure bend of the drift explains. A bend widens the contact point's
///    standard deviation by the shift that it causes, as far as the bend is likely
///    (free_travel.h).
///
/// @throws InputError for an exponent outside [1, 4].
[[nodiscard]] ContactFit fit_contact(const Approach& approach,
                                     const ContactFitOptions& options = {});

/// K d^p [N] at depth d [m] beyond the contact point; 0 for d <= 0.
[[nodiscard]] double contact_force_n(const ContactFit& fit, double depth_m);

}  // namespace palpate
