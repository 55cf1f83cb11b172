// Contact point and force law of one measured approach, found together.
//
//   F(x) = b0 + b1 x + K max(x - x0, 0)^p
//
// Symbols: x displacement [m], F force [N], b0 + b1 x baseline and drift [N], [N/m],
// x0 contact point [m], p exponent [-], K coefficient [N/m^p]. Detectors that wait for
// the force to rise are late (by 0.2 to 1 mm over 5 mm); the joint fit is unbiased as
// long as p is free.
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
  double noise_relative = 0.0;  ///< [-] as told
  /// Where the law surely misses the curve: the same law for as much of its beginning -
  /// up to 40, 15 or 5 % of the force - as it does not miss; null where it misses all
  std::shared_ptr<const ContactFit> beginning;

  [[nodiscard]] bool has(FitFlag flag) const;
};

struct ContactFitOptions {
  std::optional<double> exponent = {};  ///< [-] [1, 4] held; free without
  double noise_relative = 0.0;  ///< [-] [0, 1) part of the noise that grows with force
};

/// Least squares from several starts with a robust loss, then without loss on the
/// inliers; standard deviations from the residuals' own noise, white and shared by
/// neighbours. Parameters at a bound are held there and named. The drift is expected to
/// lift the force by no more than a tenth of its range (one standard deviation), which
/// matters where the free travel is short; one too short to tell drift from contact is
/// fitted without drift, where that fits as well. Where no free travel can be told from
/// contact - contact point among the first samples, or a "drift" that lifts the force
/// by more than 10 % of its range before contact - the contact point is assumed at the
/// first sample, the drift zero, and that is flagged - unless the approach is known to
/// be free at first (contact_from_m): the contact point is then not before that, and
/// the drift is always fitted.
/// Where the law surely misses the curve (misfit.h), no drift lifts the force by more
/// than that tenth, however uncertain it is, and contact is not assumed at the first
/// sample where the curve's beginning has free travel. With a free exponent
/// `contact` is then that of the longest beginning that the law follows (0.4, 0.15 or
/// 0.05 of the force), and the most that it differs from those of the whole and of the
/// next longer and shorter beginning is part of its standard deviation; where the law
/// follows none, that of what precedes the first fall counts, or it is not identified.
/// What the noise before contact explains is not missed by the law, nor what a sure
/// bend of the drift explains; a bend widens the contact point's standard deviation by
/// what it moves it, as far as it is likely (free_travel.h).
/// @throws InputError for an exponent outside [1, 4].
[[nodiscard]] ContactFit fit_contact(const Approach& approach,
                                     const ContactFitOptions& options = {});

/// K d^p [N] at depth d [m] beyond the contact point; 0 for d <= 0.
[[nodiscard]] double contact_force_n(const ContactFit& fit, double depth_m);

}  // namespace palpate
