// One sparse Cholesky factorisation, shared by every thread that solves with it.
#pragma once

#include <cstdint>
#include <memory>

#include <Eigen/Core>

#include "precompute/linear_elasticity.h"

namespace palpate {

/// K = L L^T of a symmetric positive definite matrix (CHOLMOD, supernodal, METIS).
class CholeskyFactor {
 public:
  /// @param lower lower triangle of K.
  /// @throws NumericalError if K is not positive definite (a body that nothing holds),
  /// or memory does not suffice.
  explicit CholeskyFactor(const Stiffness& lower);
  ~CholeskyFactor();
  CholeskyFactor(CholeskyFactor&&) noexcept;
  CholeskyFactor& operator=(CholeskyFactor&&) noexcept;

  /// X = K^-1 B, B (n x k). Safe to call from several threads at once; the result does
  /// not depend on them. Blocks of 64 columns cost several times less than single ones.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;

  [[nodiscard]] std::int64_t size() const;
  [[nodiscard]] std::int64_t factor_nonzeros() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
