// A stiffness by blocks of unknowns, read in another order: what a factor starts from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "precompute/fem/linear_elasticity.h"
#include "precompute/fem/symbolic_factor.h"

namespace palpate {

/// 3 where K (lower triangle) consists of whole 3 x 3 blocks, else 1. A body has such
/// blocks if its nodes are held in all directions or in none.
[[nodiscard]] std::ptrdiff_t block_size(const Stiffness& lower);

/// Of K's blocks of that size.
[[nodiscard]] LowerPattern pattern_of(const Stiffness& lower, std::ptrdiff_t block);

/// The blocks of K by blocks of columns of the factor.
class PermutedStiffness {
 public:
  /// @param order (blocks) block of unknowns that is eliminated k-th. K and it must
  /// outlive this.
  PermutedStiffness(const Stiffness& lower, std::ptrdiff_t block,
                    const std::vector<std::int32_t>& order);

  /// Adds K's columns of the blocks first to last - 1 of the order to `numbers`, by
  /// columns, `ld` apart. @param local row of each block of rows among the numbers'.
  void add_to(std::int32_t first, std::int32_t last,
              const std::vector<std::int32_t>& local, double* numbers,
              std::ptrdiff_t ld) const;

 private:
  struct Above {
    std::int64_t column, slot;
  };
  [[nodiscard]] std::int64_t blocks_in(std::int64_t column) const;
  [[nodiscard]] std::int64_t row_of(std::int64_t column, std::int64_t slot) const;
  template <typename Visit>
  void for_each_below(const Visit& visit) const;
  void add_block(std::int64_t column, std::int64_t slot, bool transposed, double* to,
                 std::ptrdiff_t ld) const;

  const Stiffness& lower_;
  std::ptrdiff_t block_;
  const std::vector<std::int32_t>& order_;
  std::vector<std::int32_t> place_;  // of each block of unknowns in the order
  std::vector<std::int64_t> above_begin_;
  std::vector<Above> above_;  // blocks of each row, left of the diagonal
};

}  // namespace palpate
