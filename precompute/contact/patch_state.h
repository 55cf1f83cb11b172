// How a linear contact bears at one depth: the moments of its pressure, and its lateral
// stiffness while it sticks.
#pragma once

#include <cstdint>
#include <span>

#include "formats/response/contact_table.h"
#include "precompute/contact/contact_surface.h"
#include "precompute/contact/linear_indentation.h"
#include "precompute/contact/surface_compliance.h"
#include "precompute/fem/cholesky_factor.h"

namespace palpate {

/// Adds the states of an indentation's samples that bear force: the pressure's centre,
/// second moments, and exponent by its fourth moment (contact_table.h). A node's
/// pressure spreads over the node's hat.
/// @param patch, path as for indent().
void add_pressure_states(const ContactSurface& surface,
                         std::span<const std::int32_t> patch,
                         const IndentationPath& path, Indentation& indentation);

/// Adds the lateral stiffness. It is solved at kContactDepths samples, evenly spaced.
/// With S the nodes in contact, A their normal compliance, W that along the surface,
/// and g their gaps' rate with the depth,
///
///   q = A_SS^-1 g_S / sum,   k_n = (g^T q)^2 / (q^T A q),   K_t = (q^T W q)^-1,
///
/// the ratio K_t / k_n is kept. q is the pressure of a rigid punch on S, and the shape
/// of the traction that moves S as a whole along the surface (Mindlin 1949). Of all
/// tractions the true one has the least compliance. So the stiffness is at most true,
/// and off by the square of what q is. The contact's coarseness cancels in the ratio.
/// Like Mindlin's solution the state leaves out that tractions along the surface also
/// move it inward. Nothing is added where the tool loses contact on its way.
/// @param compliance with the columns of the patch.
void add_lateral_states(const CholeskyFactor& factor, const Supports& supports,
                        const ContactSurface& surface,
                        const SurfaceCompliance& compliance,
                        std::span<const std::int32_t> patch,
                        const IndentationPath& path, Indentation& indentation);

/// Of an indentation with samples past the touch, as it is stored: at shares of the
/// last sample's depth. The lateral part takes the stiffness dN/d(depth) of the
/// samples. Without states, or with samples that lose contact, it is empty.
[[nodiscard]] ContactTable stored_contact(const Indentation& indentation,
                                          const IndentationPath& path);

}  // namespace palpate
