// A tangent without negative curvature, along whose Newton step energy always falls.
#pragma once

#include <Eigen/Core>

#include "precompute/material/law_response.h"

namespace palpate {

/// Replaces the tangent's negative eigenvalues by zero.
///
/// For an isotropic law, with F = U S V', the tangent has a block of three by three
/// between the dyads u_i v_i'. Each pair u_i v_j', u_j v_i' has a block of two by two
/// (Smith, De Goes and Kim 2019, "Analytic eigensystems for isotropic distortion
/// energies"). So there are four small eigenvalue problems instead of the large one of
/// other laws.
/// @param F [-] where the tangent was taken.
void clip_negative(const Eigen::Matrix3d& F, Tangent& tangent);

}  // namespace palpate
