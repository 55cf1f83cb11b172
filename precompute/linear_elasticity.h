// Stiffness of linear elastic bodies on quadratic tetrahedra.
#pragma once

#include <cstdint>

#include <Eigen/SparseCore>

#include "precompute/quadratic_mesh.h"

namespace palpate {

/// Isotropic, small strain: sigma = lambda tr(eps) 1 + 2 G eps.
struct LinearMaterial {
  double youngs_modulus_pa = 0.0;  ///< [Pa] (0, inf)
  double poissons_ratio = 0.0;     ///< [-] (-1, 0.5)
};

using Stiffness = Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t>;

/// K [N/m], (3 n_nodes x 3 n_nodes), lower triangle only; degree of freedom 3 node +
/// axis.
///
/// K_ab = integral of B_a^T C B_b over each tet; on straight-edged quadratic tets the
/// integrand is quadratic and the four-point rule (Hammer, Marlowe, Stroud 1956) exact.
/// @throws NumericalError naming the first tet of no positive volume.
[[nodiscard]] Stiffness assemble_stiffness(const QuadraticMesh& mesh,
                                           const LinearMaterial& material);

}  // namespace palpate
