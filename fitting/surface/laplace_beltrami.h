// Linear finite elements of the Laplace-Beltrami operator on a triangle surface.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

using SparseSquare = Eigen::SparseMatrix<double>;

struct SurfaceOperator {
  /// (n) [m^2] lumped mass C: a third of the area of each of a vertex's triangles
  Eigen::VectorXd mass_m2;
  /// (n x n) [-] G: G_ij is the integral of grad phi_i . grad phi_j, by cotangents
  /// (Pinkall and Polthier 1993); symmetric, positive semidefinite, rows sum to 0
  SparseSquare stiffness;
};

/// @throws InputError for a triangle without area, or a vertex without a triangle.
[[nodiscard]] SurfaceOperator surface_operator(const SurfaceMesh& mesh);

}  // namespace palpate
