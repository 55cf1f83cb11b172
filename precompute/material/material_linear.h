// The two isotropic laws that are quadratic in a strain: small strain and Green strain.
#pragma once

#include "precompute/material/law_response.h"

namespace palpate {

/// Small strain: Psi = mu eps:eps + lambda/2 (tr eps)^2, eps = sym(F) - 1. Stress is
/// linear in F. For lambda > 0 the second term is the volume term, otherwise
/// (Poisson's ratio <= 0) it stays in the distortion: a volume modulus is never
/// negative.
struct Linear {
  double shear_modulus_pa = 0.0;  ///< [Pa] mu > 0
  double lame_lambda_pa = 0.0;    ///< [Pa] lambda > -2/3 mu
};

/// The same form in the Green strain E = (F'F - 1)/2: Psi = mu E:E + lambda/2 (tr E)^2
/// (Saint-Venant, Kirchhoff). Right for large rotations; softens and collapses under
/// large compression.
struct StVenantKirchhoff {
  double shear_modulus_pa = 0.0;  ///< [Pa] mu > 0
  double lame_lambda_pa = 0.0;    ///< [Pa] lambda > -2/3 mu
};

/// @param poissons_ratio in (-1, 0.5). @throws InputError naming what is out of range.
[[nodiscard]] Linear linear(double youngs_modulus_pa, double poissons_ratio);
[[nodiscard]] StVenantKirchhoff st_venant_kirchhoff(double youngs_modulus_pa,
                                                    double poissons_ratio);

[[nodiscard]] double distortion_energy(const Linear& law, const Eigen::Matrix3d& F);
[[nodiscard]] LocalResponse distortion_response(const Linear& law,
                                                const Eigen::Matrix3d& F);
[[nodiscard]] VolumeTerm volume_term(const Linear& law);
[[nodiscard]] SmallStrainModuli small_strain_moduli(const Linear& law);

[[nodiscard]] double distortion_energy(const StVenantKirchhoff& law,
                                       const Eigen::Matrix3d& F);
[[nodiscard]] LocalResponse distortion_response(const StVenantKirchhoff& law,
                                                const Eigen::Matrix3d& F);
[[nodiscard]] VolumeTerm volume_term(const StVenantKirchhoff& law);
[[nodiscard]] SmallStrainModuli small_strain_moduli(const StVenantKirchhoff& law);

}  // namespace palpate
