// A sphere that sticks, pressed into a soft half-space: the law of Johnson, Kendall and
// Roberts (1971).
//
//   F = 4 E a^3 / (3 R) - sqrt(8 pi W E a^3),   d = a^2 / R - sqrt(2 pi W a / E)
//
// Symbols: a radius of contact [m], F force [N], d depth from the undeformed surface
// [m]. E is the reduced modulus, Young's modulus / (1 - Poisson's ratio^2) [Pa]. W is
// the work of adhesion [J/m^2], R the sphere's radius [m]. The law holds where the
// Tabor number (R W^2 / (E^2 z^3))^(1/3), z about 0.3 nm, is large: soft specimens and
// tools one can see.
#pragma once

#include <limits>
#include <string>

#include "fitting/curve/adhesion.h"

namespace palpate {

/// Force [N] at depth d [m] on the branch that is stable while the depth is held. Below
/// the least depth of that branch, the force at that depth.
[[nodiscard]] double jkr_force_n(double depth_m, double radius_m,
                                 double reduced_modulus_pa, double work_j_per_m2);

struct JkrFit {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  std::string refused;                ///< why there is none; empty where there is
  double contact_point_m = kUnknown;  ///< [m] the undeformed surface
  double contact_point_sd_m = kUnknown;
  double reduced_modulus_pa = kUnknown;
  double reduced_modulus_sd_pa = kUnknown;
  double work_j_per_m2 = kUnknown;  ///< [J/m^2] of the approach
  double work_sd_j_per_m2 = kUnknown;
  double pull_off_work_j_per_m2 = kUnknown;  ///< [J/m^2] of the pull-off force
  double rms_n = kUnknown;                   ///< [N]
};

constexpr double kAdhesionHysteresisMax = 1.5;
constexpr double kJkrMisfit = 3.0;  ///< rms over noise

/// Contact point, modulus and work of the approach from its jump into contact on, over
/// the baseline of find_adhesion(). Refused where no jump or no pull-off is seen.
/// Refused where works of approach and pull-off differ by more than
/// kAdhesionHysteresisMax, so that contact is not in equilibrium. Refused deeper than a
/// quarter of the radius, and beyond kJkrMisfit.
[[nodiscard]] JkrFit fit_jkr(const Approach& approach, const Adhesion& adhesion,
                             double radius_m);

}  // namespace palpate
