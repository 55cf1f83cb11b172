// A sphere on a layer bonded to a rigid base, fitted to one approach.
//
//   F(x) = b0 + b1 x + 4/3 E / (1 - nu^2) sqrt(R) d^1.5 k(sqrt(R d) / h),  d = x - x0
//
// k the layer's stiffening (moduli.h). It stiffens faster than any power of the depth,
// so that the power law's contact point is not quite its own.
#pragma once

#include "fitting/curve/measured_approach.h"
#include "fitting/curve/power_law_fit.h"
#include "fitting/material/indenter.h"

namespace palpate {

struct LayerFit {
  double youngs_modulus_pa = 0.0;
  double sd_pa = 0.0;  ///< [Pa] baseline and contact point free; NaN: unknown
  double contact_point_m = 0.0;
  double contact_point_sd_m = 0.0;
};

/// Least squares with b0, b1 (unless `start` has no drift), x0 and E free.
/// @param start the power law's fit. @param indenter a sphere with a thickness.
/// @throws InputError where the layer is thinner than the factor knows,
/// NumericalError without convergence.
[[nodiscard]] LayerFit fit_sphere_on_layer(const Approach& approach,
                                           const ContactFit& start,
                                           const Indenter& indenter);

}  // namespace palpate
