// One sparse Cholesky factorisation, shared by every thread that solves with it.
//
// Left-looking and supernodal (Ng and Peyton 1993; Chen, Davis, Hager, Rajamanickam
// 2008), over blocks of three unknowns where K has them; the dense work is of
// precompute/lanes, and so has the same bits on every processor.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "precompute/fem/linear_elasticity.h"
#include "precompute/lanes/factor_kernels.h"

namespace palpate {

/// Right-hand sides row by row, as solves work on them: (unknowns x width).
using SolveRows =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Columns that SolveRows need for so many right-hand sides; the rest are zero.
[[nodiscard]] constexpr Eigen::Index solve_width(Eigen::Index right_hand_sides) {
  return (right_hand_sides + kSolveWidth - 1) / kSolveWidth * kSolveWidth;
}

/// The columns of L that some unknowns reach through the elimination tree. Where a
/// right-hand side acts on them alone and only their displacement is wanted,
/// substitution touches no other column: a solve costs what these hold, whatever else
/// the body has. Must not outlive its factor.
class FactorPart {
 public:
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

  /// The same with L's numbers rounded to single precision, for single right-hand sides
  /// alone, which take half the time: to go through L is what they wait for. It solves
  /// with a matrix that is 1e-7 off, relative to the largest entries: a preconditioner.
  /// L is divided by its largest pivot first, so that no unit of stiffness matters.
  [[nodiscard]] FactorPart rounded() const;

 private:
  friend class CholeskyFactor;
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

/// K = L L^T of a symmetric positive definite matrix.
class CholeskyFactor {
 public:
  /// @param lower lower triangle of K. @param near unknowns that will be asked for by
  /// part(), any order: they are eliminated last where that costs less, so that their
  /// part is small.
  /// @throws NumericalError if K is not positive definite (a body that nothing holds),
  /// or memory does not suffice.
  explicit CholeskyFactor(const Stiffness& lower,
                          std::span<const std::int64_t> near = {});
  ~CholeskyFactor();
  CholeskyFactor(CholeskyFactor&&) noexcept;
  CholeskyFactor& operator=(CholeskyFactor&&) noexcept;

  /// The factor of another matrix of the same pattern, in the same order: only numbers
  /// are computed anew. @throws NumericalError if it is not positive definite.
  [[nodiscard]] CholeskyFactor refactored(const Stiffness& lower) const;

  /// X = K^-1 B, B (n x k). Safe to call from several threads at once; the result does
  /// not depend on them. Many columns cost several times less than single ones.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;

  /// @param unknowns any order; those below 0 are passed over.
  [[nodiscard]] FactorPart part(std::span<const std::int64_t> unknowns) const;

  [[nodiscard]] std::int64_t size() const;
  [[nodiscard]] std::int64_t factor_nonzeros() const;

 private:
  struct Impl;
  explicit CholeskyFactor(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
