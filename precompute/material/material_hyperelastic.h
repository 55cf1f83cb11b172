// Isotropic hyperelastic laws in the invariants of the isochoric deformation.
//
// Ibar1 = J^(-2/3) I1, Ibar2 = J^(-4/3) I2, J = det F; I1, I2 are the invariants of
// F'F. The volume term is K/2 (J - 1)^2. Energy is +inf for J <= 0.
#pragma once

#include "precompute/material/law_response.h"

namespace palpate {

/// Psi = mu/2 (Ibar1 - 3) + K/2 (J - 1)^2.
struct NeoHookean {
  double shear_modulus_pa = 0.0;  ///< [Pa] mu > 0
  double bulk_modulus_pa = 0.0;   ///< [Pa] K > 0
};

/// Psi = c10 (Ibar1 - 3) + c01 (Ibar2 - 3) + K/2 (J - 1)^2; mu = 2 (c10 + c01) > 0.
struct MooneyRivlin {
  double c10_pa = 0.0;           ///< [Pa]
  double c01_pa = 0.0;           ///< [Pa]
  double bulk_modulus_pa = 0.0;  ///< [Pa] K > 0
};

/// @param poissons_ratio in (-1, 0.5). @throws InputError naming what is out of range.
[[nodiscard]] NeoHookean neo_hookean(double youngs_modulus_pa, double poissons_ratio);

/// One of the constants may be negative, their sum may not: c10 + c01 > 0.
/// @throws InputError naming what is out of range.
[[nodiscard]] MooneyRivlin mooney_rivlin(double c10_pa, double c01_pa,
                                         double poissons_ratio);

[[nodiscard]] double distortion_energy(const NeoHookean& law, const Eigen::Matrix3d& F);
[[nodiscard]] LocalResponse distortion_response(const NeoHookean& law,
                                                const Eigen::Matrix3d& F);
[[nodiscard]] VolumeTerm volume_term(const NeoHookean& law);
[[nodiscard]] SmallStrainModuli small_strain_moduli(const NeoHookean& law);

[[nodiscard]] double distortion_energy(const MooneyRivlin& law,
                                       const Eigen::Matrix3d& F);
[[nodiscard]] LocalResponse distortion_response(const MooneyRivlin& law,
                                                const Eigen::Matrix3d& F);
[[nodiscard]] VolumeTerm volume_term(const MooneyRivlin& law);
[[nodiscard]] SmallStrainModuli small_strain_moduli(const MooneyRivlin& law);

}  // namespace palpate
