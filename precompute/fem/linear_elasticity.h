// Stiffness of a body at rest on quadratic tetrahedra.
#pragma once

#include <cstdint>
#include <span>

#include <Eigen/SparseCore>

#include "precompute/fem/quadratic_mesh.h"
#include "precompute/material/material.h"

namespace palpate {

using Stiffness = Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t>;

/// K [N/m], (3 n_nodes x 3 n_nodes), lower triangle only; degree of freedom 3 node +
/// axis.
///
/// The elements' second derivatives of energy at rest (element_response at u = 0), so
/// that a nonlinear law starts from the very matrix.
/// @param material by region. @throws NumericalError naming the first tet of no
/// positive volume.
[[nodiscard]] Stiffness assemble_stiffness(const QuadraticMesh& mesh,
                                           std::span<const Material> material);

}  // namespace palpate
