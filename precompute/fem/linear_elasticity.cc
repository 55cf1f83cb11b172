#include "precompute/fem/linear_elasticity.h"

#include <algorithm>
#include <vector>

#include "precompute/fem/quadratic_element.h"

namespace palpate {
namespace {

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
                             std::span<const Material> material) {
  const auto below = lower_pattern(mesh);
  Stiffness K = zero_stiffness(below);
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    const ElementMatrix Ke =
        element_response(element_geometry(tet_corners(mesh, t), t),
                         material[static_cast<std::size_t>(region_of(mesh, t))],
                         ElementVector::Zero())
            .stiffness;
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
