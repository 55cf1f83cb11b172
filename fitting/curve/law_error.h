// How well a fitted law knows the force at a depth.
#pragma once

#include <Eigen/Core>

#include "fitting/curve/family_fit.h"
#include "fitting/curve/measured_approach.h"
#include "fitting/curve/power_law_fit.h"

namespace palpate {

/// Standard error [-] of the logarithm of K d^p at each depth d [m] (k), d > 0 and at
/// most a few times the measured one. The error's square is g^T C g, with g the
/// gradient by the free parameters. C is the covariance of baseline, drift, contact
/// point, exponent and coefficient under the noise of the approach
/// (covariance_under_noise). The depth counts from the fitted contact point, whose
/// error is part of C. Infinite where the parameters cannot be separated. What the law
/// surely misses of the approach counts as smooth noise.
/// @param fit of this approach, not an empty run.
[[nodiscard]] Eigen::VectorXd log_force_errors(const Approach& approach,
                                               const ContactFit& fit,
                                               const Eigen::VectorXd& depth_m);

/// The same of a family's curve, from the covariance of its shape. Where the contact
/// point is the power law's, its error e adds e f' / f. Infinite where the covariance
/// is not known, or the force is zero.
[[nodiscard]] Eigen::VectorXd log_force_errors(const FamilyFit& fit,
                                               const Eigen::VectorXd& depth_m);

}  // namespace palpate
