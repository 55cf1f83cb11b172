// How deep the tip of a needle's shaft sinks into a half-space at a force.
#pragma once

namespace palpate {

/// Moduli for small strains.
struct TipTissue {
  double youngs_modulus_pa = 0.0;  ///< [Pa] > 0
  double poissons_ratio = 0.0;     ///< [-] (-1, 0.5]
};

/// The end of a needle's shaft.
struct NeedleTip {
  double radius_m = 0.0;  ///< [m] > 0 of the shaft
  /// [rad] (0, pi/2) between axis and flank of a cone; 0: the tip is a hemisphere.
  double half_angle_rad = 0.0;
};

/// h [m] by linear elasticity: an exact sphere (Sneddon 1965, equations 6.9 and 6.10).
/// With the contact's radius a = R tanh t,
///
///   h = R t tanh t,   F = E / (1 - nu^2) R^2 ((1 + tanh^2 t) t - tanh t).
///
/// Deep down the sphere is as stiff as a flat punch: dF/dh = 2 E R / (1 - nu^2).
/// @param force_n [N] >= 0. @param radius_m [m] > 0.
[[nodiscard]] double linear_tip_depth_m(const TipTissue& tissue, double radius_m,
                                        double force_n);

/// h [m] of a hemisphere in a neo-Hookean half-space, by finite elements that follow it
/// deep down (tests/bench/deep_tip): without friction, alike around the axis. With
/// f = F / (E R^2) and c below, h / R is a function of f / c alone. It was computed for
/// nu = 1/2 from R / 20 to 5.5 R, to 0.7 %.
///
/// Deep down the tip draws the tissue over the shaft like a thimble. F is 0.82 of
/// Hertz' at R and 0.40 at 5 R. It tends to 2 pi G R h, so that the slope is taken on
/// from 5.5 R to 2 pi G R. There nothing was computed.
///
///   c = c_d - (c_d - c_0) / (1 + f / 2),  c_0 = (3/4) / (1 - nu^2),
///                                           c_d = (3/2) / (1 + nu)
///
/// c turns nu = 1/2 into others: c_0 by Hertz' modulus, c_d by 2 pi G R. Its force is
/// off by 1 % for nu = 0.45, by 4 % for 0.3.
/// @param force_n [N] >= 0. @param radius_m [m] > 0.
[[nodiscard]] double nonlinear_tip_depth_m(const TipTissue& tissue, double radius_m,
                                           double force_n);

/// h [m] of a cone of half-angle alpha that ends in a shaft of radius R, by linear
/// elasticity (Sneddon 1965, cone and flat punch). It is a cone's until the contact's
/// radius a = (2/pi) h tan alpha reaches R. From there on the contact cannot widen, and
/// deepens as under a flat punch:
///
///   F = (2/pi) E / (1 - nu^2) tan alpha h^2   up to F_R = (pi/2) E / (1 - nu^2) R^2
///                                             / tan alpha
///   dF/dh = 2 E R / (1 - nu^2)                beyond
///
/// Force and slope are continuous at F_R. The shaft's side bears nothing.
/// @param tip with an angle. @param force_n [N] >= 0.
[[nodiscard]] double linear_cone_depth_m(const TipTissue& tissue, const NeedleTip& tip,
                                         double force_n);

/// [-] Depth over radius down to which nonlinear_tip_depth_m() was computed.
inline constexpr double kComputedRadii = 5.5;

}  // namespace palpate
