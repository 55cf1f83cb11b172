// The nonlinear least-squares problem behind a contact fit, in scaled parameters.
#pragma once

#include <array>

#include <Eigen/Core>

#include "fitting/curve/power_law_start.h"
#include "fitting/numerics/correlated_noise.h"

namespace palpate {

/// Order of the parameters in arrays.
enum ContactParameter {
  kBaselineForce,
  kBaselineSlope,
  kContact,
  kExponent,
  kCoefficient,
  kContactParameters
};

using HeldParameters = std::array<bool, kContactParameters>;

constexpr double kExponentMin = 1.0;
constexpr double kExponentMax = 4.0;
constexpr double kCoefficientMin = 1e-9;  ///< [-] of the force range at full travel

struct ContactSolveReport {
  ContactModel model;
  double cost = 0.0;  ///< [-] half the sum of (robustified) squares
  int iterations = 0;
  bool converged = false;
};

/// Minimises the sum of squared residuals, and of drift_weight times the slope, from
/// `start` by Levenberg-Marquardt (Ceres). Bounds: exponent [1, 4], coefficient >=
/// kCoefficientMin, contact [contact_min, 1].
/// @param loss_scale residual [-] beyond which Cauchy's loss replaces the square; 0 for
/// plain least squares. With a loss it stops at 1e-6 of the cost (it serves to find the
/// inliers), without at 1e-13.
[[nodiscard]] ContactSolveReport solve_contact(const ScaledCurve& curve,
                                               const ContactModel& start,
                                               const HeldParameters& held,
                                               double loss_scale);

/// Residuals weight (model - f) (n).
[[nodiscard]] std::vector<double> contact_residuals(const ScaledCurve& curve,
                                                    const ContactModel& model);

/// Covariance of the parameters at a plain least-squares solution, under the noise of
/// its residuals (least_squares_covariance); rows and columns of held ones are zero.
/// (5 x 5); all NaN where the free parameters cannot be separated.
[[nodiscard]] Eigen::Matrix<double, kContactParameters, kContactParameters>
contact_covariance(const ScaledCurve& curve, const ContactModel& model,
                   const HeldParameters& held, SharedNoise kinds = SharedNoise::kRough);

}  // namespace palpate
