// The columns of a sparse factor by supernodes, and the part of them that some unknowns
// need.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "precompute/lanes/factor_kernels.h"

namespace palpate {

/// Right-hand sides row by row, as solves work on them: (unknowns x width).
using SolveRows =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Columns that SolveRows need for so many right-hand sides; the rest are zero.
[[nodiscard]] constexpr Eigen::Index solve_width(Eigen::Index right_hand_sides) {
  return (right_hand_sides + kSolveWidth - 1) / kSolveWidth * kSolveWidth;
}

/// Working space of this thread, kept until it asks again.
[[nodiscard]] double* factor_space(std::ptrdiff_t doubles);

/// As SupernodeView lays them out, which see. Others own the numbers.
struct Supernodes {
  std::vector<std::int32_t> begin;
  std::vector<std::int64_t> row_begin{0};
  std::vector<std::int32_t> row;
  std::vector<const double*> number;
  std::vector<const float*> rounded;  ///< or empty

  [[nodiscard]] std::size_t count() const { return number.size(); }
  [[nodiscard]] std::ptrdiff_t columns(std::size_t s) const {
    return begin[s + 1] - begin[s];
  }
  [[nodiscard]] std::ptrdiff_t rows(std::size_t s) const {
    return row_begin[s + 1] - row_begin[s];
  }
  [[nodiscard]] std::ptrdiff_t unknowns() const {
    return begin.empty() ? 0 : begin.back();
  }
  [[nodiscard]] std::int64_t nonzeros() const;
  [[nodiscard]] SupernodeView view() const;
  void solve(SolveRows& X) const;
  void solve(Eigen::VectorXd& x) const;
};

/// The columns of L that some unknowns reach through the elimination tree. A right-hand
/// side may act on these unknowns alone, and only their displacement be wanted.
/// Substitution then touches no other column: a solve costs what these columns hold,
/// whatever else the body has. Must not outlive its factor.
class FactorPart {
 public:
  FactorPart() = default;  ///< nothing, and not to be asked
  /// @param row as row().
  FactorPart(Supernodes nodes, std::vector<std::int64_t> row);

  /// (n) row of each unknown of K in solve(), -1: not in the part. Some more than were
  /// asked for are.
  [[nodiscard]] const std::vector<std::int64_t>& row() const;
  [[nodiscard]] Eigen::Index size() const;
  [[nodiscard]] std::int64_t nonzeros() const;
  /// Its columns, rows as row() says; as long as this lives.
  [[nodiscard]] SupernodeView supernodes() const;

  /// X <- (K^-1)_part,part X, rows as row() says. As safe as CholeskyFactor::solve(),
  /// whose bits these are for as many right-hand sides, one or several.
  /// @param X (size x solve_width()), at most kSolveWidthMax wide.
  void solve(SolveRows& X) const;
  /// One right-hand side, (size).
  void solve(Eigen::VectorXd& x) const;

  /// The same part with L's numbers rounded to single precision, for single right-hand
  /// sides alone. These take 0.6 to 0.8 of the time: they wait for the pass through L.
  /// The rounded part solves with a matrix that is 1e-7 off, relative to the largest
  /// entries: a preconditioner. L is divided by its largest pivot first, so that no
  /// unit of stiffness matters.
  [[nodiscard]] FactorPart rounded() const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

}  // namespace palpate
