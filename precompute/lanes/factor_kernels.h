// The dense work inside a supernodal Cholesky factor, for every instruction set.
//
// A supernode is a block of columns of L with the same rows below them. Its columns are
// j = 0..k, its rows i = 0..m, of which the first k are its own columns. All arrays are
// stored column by column.
//
// Results have the same bits with every instruction set. A right-hand side's bits do
// not depend on the others that are solved beside it. But one right-hand side alone and
// several differ by rounding. Nothing here allocates, throws or reads what it was not
// given.
#pragma once

#include <cstddef>
#include <cstdint>

namespace palpate {

enum class InstructionSet : int;

/// Right-hand sides that are solved at a time are padded to a multiple of this.
inline constexpr std::ptrdiff_t kSolveWidth = 8;
/// The most at a time.
inline constexpr std::ptrdiff_t kSolveWidthMax = 64;

/// Supernodes of a factor or of a part of it. Rows are numbered so that a supernode's
/// own come one after the other and before those of its ancestors.
struct SupernodeView {
  std::ptrdiff_t count = 0;
  const std::int32_t* begin = nullptr;      ///< (count + 1) first column
  const std::int64_t* row_begin = nullptr;  ///< (count + 1) into row
  const std::int32_t* row = nullptr;  ///< the rows of each, ascending, its own first
  /// (count) blocks, (rows x columns), each followed by kSolveWidth finite numbers.
  const double* const* number = nullptr;
  std::ptrdiff_t rows_max = 0;  ///< of a supernode
  /// The same in single precision, which solve_one() reads where they are.
  const float* const* rounded = nullptr;
};

struct FactorKernels {
  /// C = A B', (m x n); A (m x k), B (n x k), C with room for product_rows(m) rows.
  /// With `lower` entries above the diagonal may be left out. @param work as
  /// product_work().
  void (*product)(std::ptrdiff_t m, std::ptrdiff_t n, std::ptrdiff_t k, const double* A,
                  std::ptrdiff_t lda, const double* B, std::ptrdiff_t ldb, double* C,
                  std::ptrdiff_t ldc, bool lower, double* work);
  /// The smallest leading dimension of C for m rows, and the work space of product()
  /// for m, n and k at most, in doubles.
  std::ptrdiff_t (*product_rows)(std::ptrdiff_t m);
  std::ptrdiff_t (*product_work)(std::ptrdiff_t m, std::ptrdiff_t n, std::ptrdiff_t k);

  /// Replaces a supernode's block of K (lower triangle, after the updates by its
  /// descendants) by that of L. What stands above the diagonal means nothing, but must
  /// be finite.
  /// @param work as factorise_work().
  /// @return the first column without a positive pivot, or k.
  std::ptrdiff_t (*factorise)(std::ptrdiff_t m, std::ptrdiff_t k, double* L,
                              std::ptrdiff_t ld, double* work);
  std::ptrdiff_t (*factorise_work)(std::ptrdiff_t m, std::ptrdiff_t k);

  /// Forward elimination of right-hand sides that stand below a factorised supernode as
  /// rows of it. Y is (rows x m), with L's rows as columns. Y's first k columns become
  /// Y L11'^-1; the product of these with L21' is subtracted from the others.
  /// @param work as product_work() of rows, m and k.
  void (*eliminate)(std::ptrdiff_t rows, std::ptrdiff_t m, std::ptrdiff_t k,
                    const double* L, std::ptrdiff_t ld, double* Y, std::ptrdiff_t ldy,
                    double* work);

  /// Solves L L' X = B in place, row by row: X (rows x width), width a multiple of
  /// kSolveWidth, at most kSolveWidthMax. @param work as solve_work().
  void (*solve)(const SupernodeView& factor, double* X, std::ptrdiff_t width,
                double* work);
  /// The same for one right-hand side; all sums are of doubles.
  void (*solve_one)(const SupernodeView& factor, double* x, double* work);
  std::ptrdiff_t (*solve_work)(const SupernodeView& factor, std::ptrdiff_t width);
};

/// Of this processor's instruction set.
[[nodiscard]] const FactorKernels& factor_kernels();
/// @param set must be one that the processor has: at most instruction_set().
[[nodiscard]] const FactorKernels& factor_kernels(InstructionSet set);

}  // namespace palpate
