// A symmetric sparse matrix of 3 x 3 blocks: one row of blocks per node.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "precompute/lanes/element_kernels.h"

namespace palpate {

/// Lists of nodes that are coupled with one another, of one fixed length.
using NodeGroups =
    Eigen::Matrix<std::int32_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Blocks (a, b), a >= b, for every pair that shares a group; the upper ones by
/// symmetry.
class BlockMatrix {
 public:
  BlockMatrix() = default;
  BlockMatrix(std::int32_t nodes, const NodeGroups& groups);

  void set_zero();

  /// A = -other, of the same pattern.
  void set_negative(const BlockMatrix& other);

  /// Adds the (3 m x 3 m) symmetric matrix of group `group` of the pattern.
  void add(Eigen::Index group, const Eigen::Ref<const Eigen::MatrixXd>& K);

  /// Adds the blocks of some groups of ten nodes, as ElementKernels::linearise() lays
  /// them out: [kElementBlocks][9][kBatch].
  /// @param groups by lane, at most kBatch.
  void add(std::span<const Eigen::Index> groups, const double (*blocks)[9][kBatch]);

  /// y += A x, both (3 n).
  void multiply_add(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;

  /// Calls visit(a, b, block) for every block (a, b), a >= b; block column by column.
  template <typename Visit>
  void for_each(const Visit& visit) const {
    for (std::int32_t a = 0; a < nodes(); ++a) {
      for (auto at = begin_[static_cast<std::size_t>(a)];
           at < begin_[static_cast<std::size_t>(a) + 1]; ++at) {
        visit(a, column_[static_cast<std::size_t>(at)], value_.data() + 9 * at);
      }
    }
  }

  /// x' A x.
  [[nodiscard]] double quadratic_form(const Eigen::VectorXd& x) const;

  [[nodiscard]] std::int32_t nodes() const {
    return static_cast<std::int32_t>(begin_.size()) - 1;
  }

 private:
  using Block = Eigen::Map<const Eigen::Matrix3d>;
  [[nodiscard]] Block block(std::int64_t at) const {
    return Block(value_.data() + 9 * at);
  }
  [[nodiscard]] std::int64_t slot(std::int32_t a, std::int32_t b) const;

  std::vector<std::int64_t> begin_{0};  // (n + 1) first block of each row
  std::vector<std::int32_t> column_;    // ascending within a row
  std::vector<double> value_;           // (9 n_blocks)
  std::vector<std::int64_t> slot_;  // of each pair of a group, -1 above the diagonal
  NodeGroups groups_;
};

}  // namespace palpate
