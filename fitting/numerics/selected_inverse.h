// The entries of a sparse matrix's inverse where its Cholesky factor has entries.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace palpate {

using SparseFactor = Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower>;

/// S = A^-1 on the pattern of the factor of A = P^T L L^T P, by Takahashi's recurrence.
/// (Takahashi, Fagan and Chin 1973; Erisman and Tinney 1975.) From the last column on:
/// S_ij = (delta_ij / L_ii - sum_{k > i} L_ki S_kj) / L_ii. Costs about as much as the
/// factorisation, and needs no column of the whole inverse.
class SelectedInverse {
 public:
  /// @param factor of A; must have succeeded.
  explicit SelectedInverse(const SparseFactor& factor);

  /// S_ij; i and j must be joined in A (or equal). NaN where the factor has no entry.
  [[nodiscard]] double at(Eigen::Index i, Eigen::Index j) const;

  /// Diagonal of S (n).
  [[nodiscard]] Eigen::VectorXd diagonal() const;

 private:
  Eigen::SparseMatrix<double> entry_;  // lower triangle of P S P^T
  Eigen::VectorXi place_;              // of A's rows in it
};

}  // namespace palpate
