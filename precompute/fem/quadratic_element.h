// A quadratic tetrahedron with straight edges: energy, nodal forces, stiffness.
//
// W(u) = sum_q w_q Psi(F_q) + V k/2 thetabar^2, F_q = 1 + sum_a u_a (x) grad N_a(x_q),
// thetabar = (1/V) sum_q w_q theta(F_q).
//
// The volume term of the law sees only the mean over the element, so that a nearly
// incompressible body does not lock. This is mean dilatation, P2/P0 (Nagtegaal, Parks,
// Rice 1974; Simo, Taylor, Pister 1985). The four-point rule (Hammer, Marlowe, Stroud
// 1956) is exact for linear laws.
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "precompute/fem/quadratic_mesh.h"
#include "precompute/material/material.h"

namespace palpate {

/// Displacements or forces of the ten nodes, 3 node + axis.
using ElementVector = Eigen::Matrix<double, 30, 1>;
using ElementMatrix = Eigen::Matrix<double, 30, 30>;

struct ElementGeometry {
  double volume_m3 = 0.0;
  /// Gradients of the shape functions at the four points, (10 x 3) [1/m].
  std::array<Eigen::Matrix<double, 10, 3>, 4> gradient;
};

/// @param corner_m (4 x 3) [m]. @throws NumericalError naming `tet` if the volume is
/// not positive.
[[nodiscard]] ElementGeometry element_geometry(
    const Eigen::Matrix<double, 4, 3>& corner_m, Eigen::Index tet);

struct ElementLinearisation {
  double energy_j = 0.0;
  ElementVector force_n;    ///< dW/du
  ElementMatrix stiffness;  ///< d2W/du2 [N/m], symmetric
};

/// Of a tet's ten nodes, out of u (3 n_nodes).
[[nodiscard]] ElementVector nodal_values(const QuadraticMesh& mesh, Eigen::Index tet,
                                         const Eigen::VectorXd& u);

/// [J]; +inf where the law does not admit the deformation.
[[nodiscard]] double element_energy(const ElementGeometry& geometry,
                                    const Material& material, const ElementVector& u_m);

/// @param convex negative eigenvalues of the laws' tangents (9 x 9) are set to zero at
/// each of the four points (Teran et al. 2005). The stiffness then has no negative
/// eigenvalues.
[[nodiscard]] ElementLinearisation element_response(const ElementGeometry& geometry,
                                                    const Material& material,
                                                    const ElementVector& u_m,
                                                    bool convex = false);

/// Largest Frobenius norm of the displacement gradient at the four points [-].
[[nodiscard]] double largest_gradient(const ElementGeometry& geometry,
                                      const ElementVector& u_m);

/// Smallest det F at the four points [-].
[[nodiscard]] double smallest_jacobian(const ElementGeometry& geometry,
                                       const ElementVector& u_m);

}  // namespace palpate
