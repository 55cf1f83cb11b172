// Where the contact point x_c is: inside an element, along the surface, or starved.
#pragma once

#include <Eigen/Core>

#include "runtime/account/real.h"
#include "runtime/element/element_cache.h"
#include "runtime/fast/element_potential.h"

namespace palpate {

/// Puts the anchor at the area coordinates `area` of the element in `slot`. Negative
/// ones mean outside; x_c is then the nearest point of the element. Interpolates all
/// that depends on x_c: u, n, t_j, mu, delta_L. Leaves k_t, q and delta_0 alone. A
/// triangle without area holds the anchor at its first corner.
void place(ElementModel& model, const ElementCache& cache, int slot,
           const Vector3& area, Real tool_radius_m) noexcept;

/// Puts the anchor on the element's point nearest to the tool, then follows the tool.
void adopt(ElementModel& model, const ElementCache& cache, int slot, const Vector3& x_m,
           Real tool_radius_m) noexcept;

/// Moves the anchor so that the tool's tangential deflection becomes tau. The move is
/// one Newton step of x - tau = a + R n(a) - d u(a), which is quadratic; the tool moves
/// little in a tick. The anchor crosses edges into neighbours that the cache holds.
/// Sets outside, starved.
/// @param tau_m [m] wanted delta_t, tangential; zero without friction.
void follow(ElementModel& model, const ElementCache& cache, const Vector3& x_m,
            const Vector3& tau_m, Real tool_radius_m) noexcept;

}  // namespace palpate
