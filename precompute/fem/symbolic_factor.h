// Where a sparse Cholesky factor has entries, and in which order its unknowns are
// eliminated (METIS' nested dissection, CHOLMOD's supernodes).
#pragma once

#include <cstdint>
#include <vector>

namespace palpate {

/// The lower triangle of a symmetric pattern, by columns; the diagonal is in it.
struct LowerPattern {
  std::vector<std::int64_t> begin;  ///< (n + 1)
  std::vector<std::int64_t> row;    ///< ascending in each column
};

/// Columns of L that have the same rows below them stand in one supernode.
struct SymbolicFactor {
  std::vector<std::int32_t> order;      ///< (n) unknown that is eliminated k-th
  std::vector<std::int32_t> begin;      ///< (n_supernodes + 1) first column
  std::vector<std::int64_t> row_begin;  ///< (n_supernodes + 1) into row
  std::vector<std::int32_t> row;        ///< of each, ascending, its own columns first
};

/// Same input, same answer, from any thread; made in a child process (run_in_child.h).
/// @throws ResourceError where memory does not suffice, and as run_in_child();
///   NumericalError where the ordering took the child down.
[[nodiscard]] SymbolicFactor symbolic_factor(const LowerPattern& pattern);

}  // namespace palpate
