#include "precompute/fem/quadratic_element.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/material/convex_tangent.h"

namespace palpate {
namespace {

using ShapeGradients = Eigen::Matrix<double, 10, 3>;
using BarycentricGradients = Eigen::Matrix<double, 4, 3>;
using Displacements = Eigen::Map<const Eigen::Matrix<double, 3, 10>>;

// Gradients of the quadratic shape functions at barycentric point L, from the constant
// gradients of the barycentric coordinates: N_i = L_i (2 L_i - 1), N_ij = 4 L_i L_j.
ShapeGradients shape_gradients(const Eigen::Vector4d& L,
                               const BarycentricGradients& d_L) {
  ShapeGradients gradient;
  for (int i = 0; i < 4; ++i) {
    gradient.row(i) = (4.0 * L[i] - 1.0) * d_L.row(i);
  }
  for (int e = 0; e < 6; ++e) {
    const auto [i, j] = kTetEdges[static_cast<std::size_t>(e)];
    gradient.row(4 + e) = 4.0 * (L[i] * d_L.row(j) + L[j] * d_L.row(i));
  }
  return gradient;
}

Eigen::Matrix3d deformation_gradient(const ShapeGradients& g, const ElementVector& u) {
  return Eigen::Matrix3d::Identity() + Displacements(u.data()) * g;
}

// f_a += w P grad N_a
void add_force(const ShapeGradients& g, const Eigen::Matrix3d& stress, double weight,
               ElementVector& force) {
  Eigen::Map<Eigen::Matrix<double, 3, 10>>(force.data()).noalias() +=
      weight * stress * g.transpose();
}

// K_ab += w grad N_a . A . grad N_b, lower triangle of blocks; A's index is 3 column +
// row of F.
void add_stiffness(const ShapeGradients& g, const Tangent& A, double weight,
                   ElementMatrix& K) {
  for (Eigen::Index b = 0; b < 10; ++b) {
    Eigen::Matrix<double, 9, 3> AB = A.leftCols<3>() * (weight * g(b, 0));
    AB += A.middleCols<3>(3) * (weight * g(b, 1));
    AB += A.rightCols<3>() * (weight * g(b, 2));
    for (Eigen::Index a = b; a < 10; ++a) {
      K.block<3, 3>(3 * a, 3 * b) += g(a, 0) * AB.topRows<3>() +
                                     g(a, 1) * AB.middleRows<3>(3) +
                                     g(a, 2) * AB.bottomRows<3>();
    }
  }
}

void mirror(ElementMatrix& K) {
  for (Eigen::Index a = 0; a < 10; ++a) {
    for (Eigen::Index b = a + 1; b < 10; ++b) {
      K.block<3, 3>(3 * a, 3 * b) = K.block<3, 3>(3 * b, 3 * a).transpose();
    }
  }
}

double mean_theta(VolumeMeasure measure, const std::array<Eigen::Matrix3d, 4>& F) {
  double sum = 0.0;
  for (const Eigen::Matrix3d& F_q : F) {
    sum += volume_theta(measure, F_q);
  }
  return 0.25 * sum;
}

std::array<Eigen::Matrix3d, 4> all_gradients(const ElementGeometry& geometry,
                                             const ElementVector& u) {
  std::array<Eigen::Matrix3d, 4> F;
  for (std::size_t q = 0; q < 4; ++q) {
    F[q] = deformation_gradient(geometry.gradient[q], u);
  }
  return F;
}

}  // namespace

ElementVector nodal_values(const QuadraticMesh& mesh, Eigen::Index tet,
                           const Eigen::VectorXd& u) {
  ElementVector values;
  for (Eigen::Index j = 0; j < 10; ++j) {
    values.segment<3>(3 * j) = u.segment<3>(3 * Eigen::Index{mesh.tet(tet, j)});
  }
  return values;
}

ElementGeometry element_geometry(const Eigen::Matrix<double, 4, 3>& corner_m,
                                 Eigen::Index tet) {
  // x = x_0 + E (L_1, L_2, L_3), E = `edges`. Rows of E^-1 are therefore the gradients
  // of L_1 to L_3 [1/m]. The gradient of L_0 is minus their sum, for the L sum to 1.
  Eigen::Matrix3d edges;
  for (int j = 0; j < 3; ++j) {
    edges.col(j) = (corner_m.row(j + 1) - corner_m.row(0)).transpose();
  }
  ElementGeometry geometry;
  geometry.volume_m3 = edges.determinant() / 6.0;
  if (!(geometry.volume_m3 > 0.0)) {
    throw NumericalError(
        fmt::format("tetrahedron {} has volume {} m^3", tet, geometry.volume_m3));
  }
  const Eigen::Matrix3d inverse = edges.inverse();
  BarycentricGradients d_L;
  d_L.bottomRows<3>() = inverse;
  d_L.row(0) = -inverse.colwise().sum();
  // Four points of weight 1/4, exact for polynomials of degree 2 (Hammer, Marlowe,
  // Stroud 1956).
  const double near = 0.25 + 0.15 * std::sqrt(5.0);  // 0.58541020
  const double far = 0.25 - 0.05 * std::sqrt(5.0);   // 0.13819660
  for (int q = 0; q < 4; ++q) {
    Eigen::Vector4d L = Eigen::Vector4d::Constant(far);
    L[q] = near;
    geometry.gradient[static_cast<std::size_t>(q)] = shape_gradients(L, d_L);
  }
  return geometry;
}

double element_energy(const ElementGeometry& geometry, const Material& material,
                      const ElementVector& u_m) {
  // W = V/4 sum_q Psi(F_q) + V k/2 thetabar^2, thetabar = 1/4 sum_q theta(F_q).
  const std::array<Eigen::Matrix3d, 4> F = all_gradients(geometry, u_m);
  double energy = 0.0;
  for (const Eigen::Matrix3d& F_q : F) {
    energy += 0.25 * geometry.volume_m3 * distortion_energy(material, F_q);
  }
  const VolumeMeasure measure = volume_measure(material);
  if (measure != VolumeMeasure::kNone) {
    const double theta = mean_theta(measure, F);
    energy += 0.5 * geometry.volume_m3 * volume_modulus_pa(material) * theta * theta;
  }
  return energy;
}

ElementLinearisation element_response(const ElementGeometry& geometry,
                                      const Material& material,
                                      const ElementVector& u_m, bool convex) {
  ElementLinearisation response{.force_n = ElementVector::Zero(),
                                .stiffness = ElementMatrix::Zero()};
  const std::array<Eigen::Matrix3d, 4> F = all_gradients(geometry, u_m);
  const double weight = 0.25 * geometry.volume_m3;
  const VolumeMeasure measure = volume_measure(material);
  const double k = volume_modulus_pa(material);
  const double theta = measure == VolumeMeasure::kNone ? 0.0 : mean_theta(measure, F);
  response.energy_j = 0.5 * geometry.volume_m3 * k * theta * theta;
  // With w = V/4, P_q = dPsi/dF + k thetabar dtheta/dF and A_q = dP_q/dF at fixed
  // thetabar:
  //   f_a  = sum_q w P_q grad N_a
  //   K_ab = sum_q w grad N_a . A_q . grad N_b + k/V d_theta_a d_theta_b^T
  ElementVector d_theta = ElementVector::Zero();  // V dthetabar/du
  for (std::size_t q = 0; q < 4; ++q) {
    LocalResponse local = distortion_response(material, F[q]);
    response.energy_j += weight * local.energy_density;
    if (measure != VolumeMeasure::kNone) {
      const VolumeResponse volume = volume_response(measure, F[q]);
      add_force(geometry.gradient[q], volume.gradient, weight, d_theta);
      local.stress += k * theta * volume.gradient;
      local.tangent += k * theta * volume.curvature;
    }
    if (convex) {
      clip_negative(F[q], local.tangent);
    }
    add_force(geometry.gradient[q], local.stress, weight, response.force_n);
    add_stiffness(geometry.gradient[q], local.tangent, weight, response.stiffness);
  }
  mirror(response.stiffness);
  if (measure != VolumeMeasure::kNone) {
    // The rank-one term is outside what is clipped: it has no negative eigenvalue for k
    // >= 0.
    response.stiffness.noalias() +=
        (k / geometry.volume_m3) * d_theta * d_theta.transpose();
  }
  return response;
}

double largest_gradient(const ElementGeometry& geometry, const ElementVector& u_m) {
  double largest = 0.0;
  for (const ShapeGradients& g : geometry.gradient) {
    largest = std::max(largest, (Displacements(u_m.data()) * g).norm());
  }
  return largest;
}

double smallest_jacobian(const ElementGeometry& geometry, const ElementVector& u_m) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const ShapeGradients& g : geometry.gradient) {
    smallest = std::min(smallest, deformation_gradient(g, u_m).determinant());
  }
  return smallest;
}

}  // namespace palpate
