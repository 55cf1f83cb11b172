#include "precompute/linear_elasticity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/LU>
#include <fmt/format.h>

#include "formats/error.h"

namespace palpate {
namespace {

using ElementStiffness = Eigen::Matrix<double, 30, 30>;
using ShapeGradients = Eigen::Matrix<double, 10, 3>;
using BarycentricGradients = Eigen::Matrix<double, 4, 3>;

// Gradients of the quadratic shape functions at barycentric point L, from the constant
// gradients of the barycentric coordinates: N_i = L_i (2 L_i - 1), N_ij = 4 L_i L_j.
ShapeGradients shape_gradients(const Eigen::Vector4d& L,
                               const BarycentricGradients& d_L) {
  constexpr std::array<std::array<int, 2>, 6> kEdges{
      {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};
  ShapeGradients gradient;
  for (int i = 0; i < 4; ++i) {
    gradient.row(i) = (4.0 * L[i] - 1.0) * d_L.row(i);
  }
  for (int e = 0; e < 6; ++e) {
    const auto [i, j] = kEdges[static_cast<std::size_t>(e)];
    gradient.row(4 + e) = 4.0 * (L[i] * d_L.row(j) + L[j] * d_L.row(i));
  }
  return gradient;
}

// lambda g_a g_b^T + G (g_b g_a^T + (g_a . g_b) 1), summed over the quadrature points.
ElementStiffness element_stiffness(const Eigen::Matrix<double, 4, 3>& corner,
                                   const LinearMaterial& material, Eigen::Index tet) {
  Eigen::Matrix3d edges;
  for (int j = 0; j < 3; ++j) {
    edges.col(j) = (corner.row(j + 1) - corner.row(0)).transpose();
  }
  const double volume = edges.determinant() / 6.0;
  if (!(volume > 0.0)) {
    throw NumericalError(fmt::format("tetrahedron {} has volume {} m^3", tet, volume));
  }
  const Eigen::Matrix3d inverse = edges.inverse();
  BarycentricGradients d_L;
  d_L.bottomRows<3>() = inverse;
  d_L.row(0) = -inverse.colwise().sum();

  const double E = material.youngs_modulus_pa;
  const double nu = material.poissons_ratio;
  const double lambda = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
  const double G = E / (2.0 * (1.0 + nu));
  const double near = 0.25 + 0.15 * std::sqrt(5.0);  // 0.58541020
  const double far = 0.25 - 0.05 * std::sqrt(5.0);   // 0.13819660
  ElementStiffness K = ElementStiffness::Zero();
  for (int q = 0; q < 4; ++q) {
    Eigen::Vector4d L = Eigen::Vector4d::Constant(far);
    L[q] = near;
    const ShapeGradients g = shape_gradients(L, d_L);
    for (Eigen::Index a = 0; a < 10; ++a) {
      for (Eigen::Index b = 0; b <= a; ++b) {
        Eigen::Matrix3d block = lambda * g.row(a).transpose() * g.row(b) +
                                G * g.row(b).transpose() * g.row(a);
        block.diagonal().array() += G * g.row(a).dot(g.row(b));
        K.block<3, 3>(3 * a, 3 * b) += 0.25 * volume * block;
      }
    }
  }
  for (Eigen::Index a = 0; a < 10; ++a) {
    for (Eigen::Index b = a + 1; b < 10; ++b) {
      K.block<3, 3>(3 * a, 3 * b) = K.block<3, 3>(3 * b, 3 * a).transpose();
    }
  }
  return K;
}

// Nodes b >= a that share a tet with node a, ascending; a itself first.
std::vector<std::vector<std::int32_t>> lower_pattern(const QuadraticMesh& mesh) {
  std::vector<std::vector<std::int32_t>> below(
      static_cast<std::size_t>(mesh.position_m.rows()));
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    for (int i = 0; i < 10; ++i) {
      for (int j = 0; j < 10; ++j) {
        if (mesh.tet(t, j) >= mesh.tet(t, i)) {
          below[static_cast<std::size_t>(mesh.tet(t, i))].push_back(mesh.tet(t, j));
        }
      }
    }
  }
  for (auto& list : below) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    list.shrink_to_fit();
  }
  return below;
}

// A lower-triangular matrix of zeros with that pattern, columns ordered by row.
Stiffness zero_stiffness(const std::vector<std::vector<std::int32_t>>& below) {
  const auto n = static_cast<std::int64_t>(3 * below.size());
  std::int64_t nonzeros = 0;
  for (const auto& list : below) {
    nonzeros += 9 * static_cast<std::int64_t>(list.size()) - 3;
  }
  Stiffness K(n, n);
  K.resizeNonZeros(nonzeros);
  std::int64_t at = 0;
  for (std::size_t a = 0; a < below.size(); ++a) {
    for (int axis = 0; axis < 3; ++axis) {
      K.outerIndexPtr()[3 * a + static_cast<std::size_t>(axis)] = at;
      for (const std::int32_t b : below[a]) {
        for (int row = static_cast<std::size_t>(b) == a ? axis : 0; row < 3; ++row) {
          K.innerIndexPtr()[at] = 3 * std::int64_t{b} + row;
          K.valuePtr()[at++] = 0.0;
        }
      }
    }
  }
  K.outerIndexPtr()[n] = at;
  return K;
}

}  // namespace

Stiffness assemble_stiffness(const QuadraticMesh& mesh,
                             const LinearMaterial& material) {
  const auto below = lower_pattern(mesh);
  Stiffness K = zero_stiffness(below);
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    Eigen::Matrix<double, 4, 3> corner;
    for (int i = 0; i < 4; ++i) {
      corner.row(i) = mesh.position_m.row(mesh.tet(t, i));
    }
    const ElementStiffness Ke = element_stiffness(corner, material, t);
    for (int i = 0; i < 10; ++i) {
      const std::int32_t a = mesh.tet(t, i);
      const auto& list = below[static_cast<std::size_t>(a)];
      for (int j = 0; j < 10; ++j) {
        const std::int32_t b = mesh.tet(t, j);
        if (b < a) {
          continue;
        }
        const auto slot =
            std::lower_bound(list.begin(), list.end(), b) - list.begin();  // b's block
        for (int axis = 0; axis < 3; ++axis) {
          // Column 3a + axis starts with 3 - axis rows of the diagonal block.
          const std::int64_t column = K.outerIndexPtr()[3 * std::int64_t{a} + axis];
          const std::int64_t start = b == a ? column - axis : column + 3 * slot - axis;
          for (int row = b == a ? axis : 0; row < 3; ++row) {
            K.valuePtr()[start + row] += Ke(3 * j + row, 3 * i + axis);
          }
        }
      }
    }
  }
  return K;
}

}  // namespace palpate
