// Young's modulus from a fitted contact, where the indenter allows one.
//
//   sphere, paraboloid's law    F = 4/3 E* sqrt(R) d^1.5, on a layer times k(d)
//   flat punch                  F = 2 E* a d, on a layer times k(a)
//   cone                        F = 2/pi E* tan(alpha) d^2
//   plate on a cylinder         F = E A d / h (uniaxial, small strain)
//
// E* = E / (1 - nu^2). Layers of thickness h bonded to a rigid base: the exact solution
// (tabled for nu 0.3 to 0.5), interpolated.
#pragma once

#include <string>
#include <vector>

#include "fitting/curve/measured_approach.h"
#include "fitting/curve/power_law_fit.h"
#include "fitting/material/indenter.h"

namespace palpate {

/// A part of a modulus' standard deviation: "data", "radius", "half_angle", "height",
/// "thickness", "poissons_ratio". Of a plate "contact" is what the contact point's
/// error makes of E. Of a plate "law" is half of what the slopes of both halves of the
/// strains differ, where they surely differ (then flagged kModulusLawMisfit). "drift"
/// is what E differs without the bend, where the drift surely bends before contact.
struct ModulusError {
  std::string name;
  double sd_pa = 0.0;
};

struct Modulus {
  double youngs_modulus_pa = 0.0;   ///< [Pa] NaN where refused
  double sd_pa = 0.0;               ///< [Pa] NaN where unknown
  std::vector<ModulusError> error;  ///< independent parts of sd_pa
  std::string law;             ///< "Hertz", "Hertz on a layer", "Sneddon punch", ...
  std::string refused;         ///< why there is none; empty where there is
  std::vector<FitFlag> flags;  ///< of the law's own fit
};

/// No modulus (with the reason) for an unknown indenter or an empty run. None either,
/// except for a plate, for a contact point that the data do not determine. The contact
/// point must be determined with a free exponent. Where the free exponent does not
/// speak against the law's (2 standard deviations), a contact point determined with the
/// law's suffices. E depends on a power of the depth, so an error of the contact point
/// becomes one of E. Flagged where a sphere's depth passes R/4, and where the free
/// exponent differs from the law's by more than 3 standard deviations and 0.1.
/// @param free the fit with a free exponent. @param indenter as read_session() checks.
[[nodiscard]] Modulus find_modulus(const Approach& approach, const ContactFit& free,
                                   const Indenter& indenter);

/// Stiffening of a flat punch of radius a on a layer: F = 2 E* a d kappa.
/// @param radius_over_thickness [-] [0, 2]; @param poissons_ratio [-] [0.3, 0.5]
/// @throws InputError outside.
[[nodiscard]] double punch_layer_factor(double radius_over_thickness,
                                        double poissons_ratio);

/// Stiffening of a sphere (paraboloid) on a layer: F over Hertz's.
/// @param chi [-] sqrt(R d) / h, up to that of a/h = 2; @param poissons_ratio as above.
/// @throws InputError outside.
[[nodiscard]] double sphere_layer_factor(double chi, double poissons_ratio);

}  // namespace palpate
