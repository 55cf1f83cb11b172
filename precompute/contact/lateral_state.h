// How stiff a contact is sideways while it sticks.
#pragma once

#include <cstdint>
#include <span>

#include "precompute/contact/linear_indentation.h"
#include "precompute/contact/near_field.h"
#include "precompute/contact/surface_compliance.h"
#include "precompute/fem/batched_solves.h"
#include "precompute/fem/cholesky_factor.h"

namespace palpate {

/// Adds the lateral stiffness. It is solved at kContactDepths samples, evenly spaced.
/// With S the nodes in contact, A their normal compliance, W that along the surface,
/// and g their gaps' rate with the depth,
///
///   q = A_SS^-1 g_S / sum,   k_n = (g^T q)^2 / (q^T A q),   K_t = e^T (T^T W T)^-1 e,
///
/// the ratio K_t / k_n is kept. q is the pressure of a rigid punch on S. T holds three
/// tractions along each axis, e their sums: q, an even one, and an even one of the rim.
/// On a half-space the traction that moves S as a whole has the shape of q (Mindlin
/// 1949). On a thin layer it is even, and larger at the rim. Of all tractions the true
/// one has the least compliance. So the stiffness is at most true, and off by the
/// square of what T misses. The contact's coarseness cancels in the ratio. Like
/// Mindlin's solution the state leaves out that tractions along the surface also move
/// it inward. Nothing is added where the tool loses contact on its way.
/// @param compliance with the columns of the patch.
void add_lateral_states(const CholeskyFactor& factor, const Supports& supports,
                        const ContactSurface& surface,
                        const SurfaceCompliance& compliance,
                        std::span<const std::int32_t> patch,
                        const IndentationPath& path, Indentation& indentation);

/// A nonlinear body at rest under a tool, pressed by a patch.
struct PressedState {
  NearField& near;  ///< of the contact's nodes, too
  const NearState& state;
  const Eigen::VectorXd& pressure_n;  ///< (n_patch)
  double penetration_m = 0.0;
};

/// The same ratio by the body's tangent there, C = L^T (K + dK)^-1 L of the loads
/// L, by conjugate gradients with K^-1 as preconditioner. States at depth d take
/// 1 + (ratio there over the linear one - 1) d / depth times theirs, by the mean over
/// directions. Nothing changes where the tangent is indefinite.
/// @param compliance (n_patch x n_patch) of the rest state, for the traction's shape.
void correct_lateral_states(const PressedState& pressed, const RestSolve& solve,
                            const ContactSurface& surface,
                            const Eigen::MatrixXd& compliance,
                            std::span<const std::int32_t> patch,
                            const IndentationPath& path, Indentation& indentation);

/// States at depth d take 1 + times d / depth of their lateral stiffness. A tangent
/// made that of it at a penetration, here or at a neighbour.
void take_tangent(Indentation& indentation, double penetration_m, double times);

}  // namespace palpate
