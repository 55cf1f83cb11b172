// The Cholesky factor of a small dense matrix, by the kernels of precompute/lanes: the
// same bits on every processor.
#pragma once

#include <Eigen/Core>

namespace palpate {

class DenseCholesky {
 public:
  /// A = L L'. @param A symmetric; its lower triangle is read.
  explicit DenseCholesky(Eigen::MatrixXd A);

  [[nodiscard]] bool is_definite() const { return definite_; }

  /// A^-1 b; only where is_definite().
  [[nodiscard]] Eigen::VectorXd solve(Eigen::VectorXd b) const;

 private:
  Eigen::MatrixXd L_;  // below its diagonal
  bool definite_ = false;
};

}  // namespace palpate
