// One sparse Cholesky factorisation, shared by every thread that solves with it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "precompute/linear_elasticity.h"

namespace palpate {

/// K = L L^T of a symmetric positive definite matrix (CHOLMOD, supernodal, METIS).
///
/// Near unknowns are eliminated last. Where a right-hand side acts on them alone and
/// only their displacement is wanted, substitution begins at their first column of L
/// and ends there: solve_near() costs what their block of L holds, whatever else the
/// body has.
class CholeskyFactor {
 public:
  /// @param lower lower triangle of K. @param near unknowns, any order; none: no
  /// solve_near().
  /// @throws NumericalError if K is not positive definite (a body that nothing holds),
  /// or memory does not suffice.
  explicit CholeskyFactor(const Stiffness& lower,
                          std::span<const std::int64_t> near = {});
  ~CholeskyFactor();
  CholeskyFactor(CholeskyFactor&&) noexcept;
  CholeskyFactor& operator=(CholeskyFactor&&) noexcept;

  /// X = K^-1 B, B (n x k). Safe to call from several threads at once; the result does
  /// not depend on them. Blocks of 64 columns cost several times less than single ones.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;

  /// (n) row of each unknown in solve_near(), -1 for those that are not near; empty
  /// where there is no solve_near(). Some more than were asked for may be near.
  [[nodiscard]] const std::vector<std::int64_t>& near_row() const;
  [[nodiscard]] Eigen::Index near_size() const;

  /// X = (K^-1)_near,near B, B (near_size x k), rows as near_row() says. As safe as
  /// solve().
  [[nodiscard]] Eigen::MatrixXd solve_near(const Eigen::MatrixXd& B) const;

  [[nodiscard]] std::int64_t size() const;
  [[nodiscard]] std::int64_t factor_nonzeros() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
