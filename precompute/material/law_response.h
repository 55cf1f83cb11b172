// What a constitutive law answers at one point, and how its tensors are laid out.
#pragma once

#include <Eigen/Core>

namespace palpate {

/// dP_i/dF_j where i, j count the entries of a 3 x 3 tensor column by column: the entry
/// (row, col) has index 3 col + row.
using Tangent = Eigen::Matrix<double, 9, 9>;

/// What a law's volume term measures; averaged over an element (mean dilatation), so
/// that nearly incompressible bodies do not lock.
enum class VolumeMeasure {
  kNone,        ///< 0: the law has no separate volume term
  kSmallTrace,  ///< tr F - 3
  kGreenTrace,  ///< tr(F'F - 1)/2
  kJacobian     ///< det F - 1
};

/// Energy and its first two derivatives by the deformation gradient F.
///
/// A law may not admit F: det F <= 0, or an energy past the largest double. The energy
/// is then +inf and stress and tangent are NaN: no caller can go on with them
/// unnoticed.
struct LocalResponse {
  double energy_density = 0.0;  ///< [J/m^3] of rest volume
  Eigen::Matrix3d stress;       ///< [Pa] first Piola-Kirchhoff stress P
  Tangent tangent;              ///< [Pa] symmetric
};

/// A volume measure theta and its first two derivatives by F [-].
struct VolumeResponse {
  double theta = 0.0;
  Eigen::Matrix3d gradient;
  Tangent curvature;
};

/// The term U = modulus_pa/2 theta^2 of a law's energy density.
struct VolumeTerm {
  VolumeMeasure measure = VolumeMeasure::kNone;
  double modulus_pa = 0.0;  ///< [Pa] >= 0
};

/// Moduli of the isotropic law that is as stiff as this one at small strain.
struct SmallStrainModuli {
  double shear_pa = 0.0;  ///< [Pa]
  double bulk_pa = 0.0;   ///< [Pa]
};

}  // namespace palpate
