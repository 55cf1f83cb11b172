#include "precompute/fem/supernodes.h"

#include <algorithm>

namespace palpate {

double* factor_space(std::ptrdiff_t doubles) {
  thread_local std::vector<double> numbers;
  const auto wanted = static_cast<std::size_t>(doubles);
  if (numbers.size() < wanted) {
    numbers.clear();
    numbers.resize(wanted);
  }
  return numbers.data();
}

std::int64_t Supernodes::nonzeros() const {
  std::int64_t sum = 0;
  for (std::size_t s = 0; s < count(); ++s) {
    sum += rows(s) * columns(s);
  }
  return sum;
}

SupernodeView Supernodes::view() const {
  SupernodeView all{static_cast<std::ptrdiff_t>(count()), begin.data(),
                    row_begin.data(), row.data(), number.data()};
  all.rounded = rounded.empty() ? nullptr : rounded.data();
  for (std::size_t s = 0; s < count(); ++s) {
    all.rows_max = std::max(all.rows_max, rows(s));
  }
  return all;
}

void Supernodes::solve(SolveRows& X) const {
  const SupernodeView all = view();
  const FactorKernels& kernels = factor_kernels();
  kernels.solve(all, X.data(), X.cols(),
                factor_space(kernels.solve_work(all, X.cols())));
}

void Supernodes::solve(Eigen::VectorXd& x) const {
  const SupernodeView all = view();
  const FactorKernels& kernels = factor_kernels();
  kernels.solve_one(all, x.data(), factor_space(kernels.solve_work(all, kSolveWidth)));
}

}  // namespace palpate
