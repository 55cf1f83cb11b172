// Transversely isotropic laws: one fibre direction, all directions across it alike.
#pragma once

#include "precompute/material/law_response.h"

namespace palpate {

/// Psi = strain:C:strain/2 with the five-constant stiffness C. The strain is the small
/// strain (stress linear in F) or, with finite_strain, the Green strain (large
/// rotations). No volume term: all of the energy is in the distortion.
struct TransverselyIsotropic {
  Tangent stiffness_pa = Tangent::Zero();  ///< [Pa] C, in body axes
  bool finite_strain = false;
};

/// Moduli that fix C, with l along the fibre and t across it. Strains from stresses:
///
///   eps_l = s_l/E_l - nu_lt/E_l (s_t + s_t')
///   eps_t = -nu_lt/E_l s_l + (s_t - nu_tt s_t')/E_t.
struct TransverseModuli {
  double youngs_along_pa = 0.0;   ///< [Pa] E_l > 0
  double youngs_across_pa = 0.0;  ///< [Pa] E_t > 0
  double shear_along_pa = 0.0;    ///< [Pa] G_lt > 0
  double poisson_lt = 0.0;  ///< [-] contraction across over stretch along the fibre
  double poisson_tt = 0.0;  ///< [-] in (-1, 1); 1 - nu_tt > 2 nu_lt^2 E_t/E_l
};

/// Fibres in a soft matrix (Holzapfel, Gasser, Ogden 2000, one family, not dispersed):
///
///   Psi = mu/2 (Ibar1 - 3) + k1/(2 k2) (exp(k2 <Ibar4 - 1>^2) - 1) + K/2 (J - 1)^2,
///   Ibar4 = J^(-2/3) |F a0|^2.
///
/// The fibres bear tension only, <x> = max(x, 0). The stress is continuous where the
/// fibres come under load; the tangent jumps there.
struct FibreExponential {
  double shear_modulus_pa = 0.0;                     ///< [Pa] mu of the matrix > 0
  double bulk_modulus_pa = 0.0;                      ///< [Pa] K > 0
  double k1_pa = 0.0;                                ///< [Pa] >= 0
  double k2 = 1.0;                                   ///< [-] > 0
  Eigen::Vector3d fibre = Eigen::Vector3d::UnitX();  ///< a0, unit length
};

/// @param fibre any length but zero. @throws InputError naming what is out of range, or
/// the combination that is not positive definite.
[[nodiscard]] TransverselyIsotropic transversely_isotropic(
    const TransverseModuli& moduli, const Eigen::Vector3d& fibre, bool finite_strain);
[[nodiscard]] TransverselyIsotropic transversely_isotropic(
    double youngs_along_pa, double youngs_across_pa, double shear_along_pa,
    double poisson_lt, double poisson_tt, const Eigen::Vector3d& fibre,
    bool finite_strain);

/// @param youngs_modulus_pa, poissons_ratio of the matrix.
/// @param fibre any length but zero. @throws InputError naming what is out of range.
[[nodiscard]] FibreExponential fibre_exponential(double youngs_modulus_pa,
                                                 double poissons_ratio, double k1_pa,
                                                 double k2,
                                                 const Eigen::Vector3d& fibre);

[[nodiscard]] double distortion_energy(const TransverselyIsotropic& law,
                                       const Eigen::Matrix3d& F);
[[nodiscard]] LocalResponse distortion_response(const TransverselyIsotropic& law,
                                                const Eigen::Matrix3d& F);
[[nodiscard]] VolumeTerm volume_term(const TransverselyIsotropic& law);
/// Means over all directions (Voigt).
[[nodiscard]] SmallStrainModuli small_strain_moduli(const TransverselyIsotropic& law);

[[nodiscard]] double distortion_energy(const FibreExponential& law,
                                       const Eigen::Matrix3d& F);
[[nodiscard]] LocalResponse distortion_response(const FibreExponential& law,
                                                const Eigen::Matrix3d& F);
[[nodiscard]] VolumeTerm volume_term(const FibreExponential& law);
/// Of the stretched state, where the fibres bear load; mean over all directions
/// (Voigt).
[[nodiscard]] SmallStrainModuli small_strain_moduli(const FibreExponential& law);

}  // namespace palpate
