#include "precompute/fem/linear_elasticity.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "precompute/fem/element_batches.h"
#include "precompute/fem/quadratic_element.h"

namespace palpate {
namespace {

// Tets of each node.
struct TetsOfNodes {
  std::vector<std::int64_t> begin;
  std::vector<std::int32_t> tet;

  explicit TetsOfNodes(const QuadraticMesh& mesh)
      : begin(static_cast<std::size_t>(mesh.position_m.rows()) + 1, 0),
        tet(static_cast<std::size_t>(mesh.tet.size())) {
    for (const std::int32_t node : mesh.tet.reshaped()) {
      ++begin[static_cast<std::size_t>(node) + 1];
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<std::int64_t> next = begin;
    for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
      for (int i = 0; i < 10; ++i) {
        auto& at = next[static_cast<std::size_t>(mesh.tet(t, i))];
        tet[static_cast<std::size_t>(at++)] = static_cast<std::int32_t>(t);
      }
    }
  }
};

// Nodes b >= a that share a tet with node a, ascending; a itself first.
std::vector<std::vector<std::int32_t>> lower_pattern(const QuadraticMesh& mesh) {
  const TetsOfNodes tets(mesh);
  const auto nodes = static_cast<std::size_t>(mesh.position_m.rows());
  std::vector<std::vector<std::int32_t>> below(nodes);
  std::vector<std::int32_t> seen_by(nodes, -1);
  for (std::size_t a = 0; a < nodes; ++a) {
    const auto self = static_cast<std::int32_t>(a);
    for (auto at = tets.begin[a]; at < tets.begin[a + 1]; ++at) {
      for (const std::int32_t b :
           mesh.tet.row(tets.tet[static_cast<std::size_t>(at)])) {
        if (b >= self && seen_by[static_cast<std::size_t>(b)] != self) {
          seen_by[static_cast<std::size_t>(b)] = self;
          below[a].push_back(b);
        }
      }
    }
    std::sort(below[a].begin(), below[a].end());
  }
  return below;
}

// A lower-triangular matrix of zeros with that pattern, columns ordered by row.
Stiffness zero_stiffness(const std::vector<std::vector<std::int32_t>>& below) {
  const auto n = static_cast<std::int64_t>(3 * below.size());
  std::int64_t nonzeros = 0;
  for (const auto& list : below) {
    // Nine entries a block; a diagonal block lacks the three above its diagonal.
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

namespace {

// Where the blocks of pairs of nodes begin in K.
class Blocks {
 public:
  Blocks(const std::vector<std::vector<std::int32_t>>& below, Stiffness& K)
      : below_(below), K_(K) {}

  // Adds the (3 x 3) block of row node b and column node a, b >= a, column by column,
  // `stride` apart; or, of the other half, transposed.
  void add(std::int32_t b, std::int32_t a, const double* block, std::size_t stride,
           bool transposed) {
    const auto& list = below_[static_cast<std::size_t>(a)];
    const auto slot = std::lower_bound(list.begin(), list.end(), b) - list.begin();
    for (int axis = 0; axis < 3; ++axis) {
      // Column 3a + axis starts with 3 - axis rows of the diagonal block.
      const std::int64_t column = K_.outerIndexPtr()[3 * std::int64_t{a} + axis];
      const std::int64_t start = column + 3 * slot - axis;
      for (int row = b == a ? axis : 0; row < 3; ++row) {
        const int entry = transposed ? 3 * row + axis : 3 * axis + row;
        K_.valuePtr()[start + row] += block[static_cast<std::size_t>(entry) * stride];
      }
    }
  }

 private:
  const std::vector<std::vector<std::int32_t>>& below_;
  Stiffness& K_;
};

}  // namespace

Stiffness assemble_stiffness(const QuadraticMesh& mesh,
                             std::span<const Material> material) {
  const auto below = lower_pattern(mesh);
  Stiffness K = zero_stiffness(below);
  Blocks blocks(below, K);
  std::vector<ElementGeometry> geometry;
  std::vector<std::int32_t> region;
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    geometry.push_back(element_geometry(tet_corners(mesh, t), t));
    region.push_back(region_of(mesh, t));
  }
  // K = sum_e d2W_e/du2 at u = 0. Batches hold the blocks (i, j), j <= i, of an
  // element.
  const ElementBatches elements(mesh.tet, geometry, region, material);
  elements.linearise(
      Eigen::VectorXd::Zero(3 * mesh.position_m.rows()), false,
      [&](const ElementBatches::Batch& batch, const BatchResponse& response) {
        for (std::size_t lane = 0; lane < batch.count; ++lane) {
          const auto nodes = mesh.tet.row(batch.element[lane]);
          for (Eigen::Index i = 0, block = 0; i < 10; ++i) {
            for (Eigen::Index j = 0; j <= i; ++j, ++block) {
              const double* from = &response.stiffness[block][0][lane];
              // K keeps rows >= columns in the mesh's numbers; otherwise the block's
              // transpose counts.
              const bool lower = nodes[i] >= nodes[j];
              blocks.add(std::max(nodes[i], nodes[j]), std::min(nodes[i], nodes[j]),
                         from, kBatch, !lower);
            }
          }
        }
      });
  return K;
}

}  // namespace palpate
