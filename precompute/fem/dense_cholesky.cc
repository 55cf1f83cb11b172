#include "precompute/fem/dense_cholesky.h"

#include <cstdint>
#include <numeric>
#include <vector>

#include "precompute/lanes/factor_kernels.h"

namespace palpate {

DenseCholesky::DenseCholesky(Eigen::MatrixXd A) : L_(std::move(A)) {
  // Kernels multiply what stands above the diagonal by zero: it must be finite.
  L_.triangularView<Eigen::StrictlyUpper>().setZero();
  const FactorKernels& kernels = factor_kernels();
  const Eigen::Index n = L_.rows();
  std::vector<double> work(static_cast<std::size_t>(kernels.factorise_work(n, n)));
  definite_ = kernels.factorise(n, n, L_.data(), n, work.data()) == n;
}

Eigen::VectorXd DenseCholesky::solve(Eigen::VectorXd b) const {
  const auto n = static_cast<std::int32_t>(L_.rows());
  const std::int32_t begin[] = {0, n};
  const std::int64_t row_begin[] = {0, n};
  std::vector<std::int32_t> row(static_cast<std::size_t>(n));
  std::iota(row.begin(), row.end(), 0);
  const double* const number = L_.data();
  const SupernodeView one{1, begin, row_begin, row.data(), &number, n};
  const FactorKernels& kernels = factor_kernels();
  std::vector<double> work(
      static_cast<std::size_t>(kernels.solve_work(one, kSolveWidth)));
  kernels.solve_one(one, b.data(), work.data());
  return b;
}

}  // namespace palpate
