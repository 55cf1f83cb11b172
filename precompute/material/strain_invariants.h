// Derivatives of the invariants of a deformation gradient that hyperelastic laws share.
//
// Allocation-free; index 3 col + row for the entries of a 3 x 3 tensor
// (law_response.h). Excess over the rest state is formed from H = F - 1, not as a
// difference of large numbers. So an energy of order |H|^2 keeps its digits, which line
// searches compare.
#pragma once

#include <cmath>
#include <limits>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "formats/base/reproducible.h"
#include "precompute/material/law_response.h"

namespace palpate {

using Vector9 = Eigen::Matrix<double, 9, 1>;

inline Eigen::Map<const Vector9> as_vector(const Eigen::Matrix3d& tensor) {
  return Eigen::Map<const Vector9>(tensor.data());
}

/// cof F = d det F / dF.
inline Eigen::Matrix3d cofactor(const Eigen::Matrix3d& F) {
  Eigen::Matrix3d cof;
  cof.col(0) = F.col(1).cross(F.col(2));
  cof.col(1) = F.col(2).cross(F.col(0));
  cof.col(2) = F.col(0).cross(F.col(1));
  return cof;
}

/// tangent += factor d cof F / dF. The block of columns (I, J) is the cross-product
/// matrix of the third column, with the sign of the permutation.
inline void add_cofactor_derivative(const Eigen::Matrix3d& F, double factor,
                                    Tangent& tangent) {
  for (int col = 0; col < 3; ++col) {
    const int next = (col + 1) % 3;
    const Eigen::Vector3d c = factor * F.col((col + 2) % 3);
    for (int row = 0; row < 3; ++row) {
      const int up = (row + 1) % 3;
      const double entry = c[(row + 2) % 3];
      tangent(3 * col + row, 3 * next + up) += entry;
      tangent(3 * col + up, 3 * next + row) -= entry;
      tangent(3 * next + up, 3 * col + row) += entry;
      tangent(3 * next + row, 3 * col + up) -= entry;
    }
  }
}

/// F'F - 1, twice the Green strain, without cancellation at small strain.
inline Eigen::Matrix3d twice_green_strain(const Eigen::Matrix3d& F) {
  const Eigen::Matrix3d H = F - Eigen::Matrix3d::Identity();
  return H + H.transpose() + H.transpose() * H;
}

/// Sum of the principal 2 x 2 minors.
inline double second_invariant(const Eigen::Matrix3d& A) {
  return A(0, 0) * A(1, 1) - A(0, 1) * A(1, 0) + A(1, 1) * A(2, 2) - A(1, 2) * A(2, 1) +
         A(2, 2) * A(0, 0) - A(2, 0) * A(0, 2);
}

struct VolumeChange {
  double J = 1.0;      ///< det F
  double log_J = 0.0;  ///< meaningful for J > 0 only
};

inline VolumeChange volume_change(const Eigen::Matrix3d& F) {
  const Eigen::Matrix3d H = F - Eigen::Matrix3d::Identity();
  if (H.squaredNorm() < 0.01) {
    const double excess = H.trace() + second_invariant(H) + H.determinant();
    return {1.0 + excess, reproducible::log1p(excess)};
  }
  const double J = F.determinant();
  return {J, J > 0.0 ? reproducible::log(J) : 0.0};
}

/// An energy past the largest double is +inf, never NaN.
inline double finite_or_infinite(double energy) {
  return std::isfinite(energy) ? energy : std::numeric_limits<double>::infinity();
}

/// What a law answers where it does not admit F.
inline LocalResponse inadmissible() {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  return {std::numeric_limits<double>::infinity(), Eigen::Matrix3d::Constant(kNan),
          Tangent::Constant(kNan)};
}

/// Adds `weight` times stress and tangent of J^-p I, but for the term J^-p d2I/dF2.
///
///   d(J^-p I)/dF   = J^-p (I' - p I g),  g = cof F / J
///   d2(J^-p I)/dF2 = J^-p (I'' - p (I' g + g I') + p (p + 1) I g g - p I dcof/J)
///
/// @param scale J^-p. @param I the invariant. @param dI its derivative by F.
inline void add_isochoric(const Eigen::Matrix3d& F, double J, double weight, double p,
                          double scale, double I, const Eigen::Matrix3d& dI,
                          LocalResponse& response) {
  const Eigen::Matrix3d cof_J = cofactor(F) / J;
  const double ws = weight * scale;
  response.stress += ws * (dI - (p * I) * cof_J);
  const auto g = as_vector(cof_J);
  const Vector9 across = (-p * ws) * as_vector(dI);
  const Vector9 along = across + (p * (p + 1.0) * I * ws) * g;
  for (int j = 0; j < 9; ++j) {
    response.tangent.col(j) += g[j] * along + across[j] * g;
  }
  add_cofactor_derivative(F, -p * I * ws / J, response.tangent);
}

}  // namespace palpate
