// One sparse Cholesky factorisation, shared by every thread that solves with it.
//
// The factorisation is left-looking and supernodal (Ng and Peyton 1993; Chen, Davis,
// Hager, Rajamanickam 2008). Its blocks have three unknowns where K has such blocks.
// precompute/lanes does the dense work, with the same bits on every processor.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "precompute/fem/factor_part.h"
#include "precompute/fem/linear_elasticity.h"

namespace palpate {

/// K = L L^T of a symmetric positive definite matrix.
class CholeskyFactor {
 public:
  /// @param lower lower triangle of K.
  /// @throws NumericalError if K is not positive definite (a body that nothing holds);
  /// as require_free_memory() where memory does not suffice.
  explicit CholeskyFactor(const Stiffness& lower);
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
