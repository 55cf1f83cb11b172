// Young's modulus from a sphere pressed into a flat, thick, elastic sample.
#pragma once

#include <string>

#include "fitting/approach.h"
#include "fitting/contact_fit.h"

namespace palpate {

struct HertzModulus {
  double youngs_modulus_pa = 0.0;  ///< [Pa]; NaN where refused
  double sd_pa = 0.0;   ///< [Pa] from the fit's covariance; NaN where refused
  std::string refused;  ///< why there is no modulus; empty if there is one
  ContactFit fit;       ///< the refit with exponent 1.5; its flags
};

/// Refits with exponent 1.5 and inverts Hertz (1882), F = 4/3 E/(1 - nu^2) sqrt(R)
/// d^1.5 for a rigid sphere:
///   E = 3 (1 - nu^2) K / (4 sqrt(R)).
/// Refused for an empty run and without an identified contact point: E goes with the
/// depth's power 1.5. Flagged where the depth passes R/4, and where the free exponent
/// of `free` differs from 1.5 by more than 3 standard deviations and 0.1.
/// @param radius_m [m] > 0. @param poissons_ratio [-] (-1, 0.5]. @throws InputError.
[[nodiscard]] HertzModulus hertz_modulus(const Approach& approach,
                                         const ContactFit& free, double radius_m,
                                         double poissons_ratio);

}  // namespace palpate
