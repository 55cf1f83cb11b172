// A tangent without negative curvature, along whose Newton step energy always falls.
#pragma once

#include <Eigen/Core>

#include "precompute/material/law_response.h"

namespace palpate {

/// Replaces the tangent's negative eigenvalues by zero.
///
/// Of an isotropic law, with F = U S V', the tangent has a block of three by three
/// between the dyads u_i v_i' and one of two by two for each pair u_i v_j', u_j v_i'
/// (Smith, De Goes and Kim 2019, "Analytic eigensystems for isotropic distortion
/// energies"): four small eigenvalue problems instead of a large one, which other laws
/// take.
/// @param F [-] where the tangent was taken.
void clip_negative(const Eigen::Matrix3d& F, Tangent& tangent);

}  // namespace palpate
