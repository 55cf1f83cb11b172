#include "precompute/fem/factor_part.h"

#include <algorithm>
#include <iterator>
#include <utility>

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

struct FactorPart::Impl {
  Supernodes nodes;
  std::vector<float> rounded;  // over the scale, or empty
  double scale = 1.0;
  std::vector<std::int64_t> row;
};

FactorPart::FactorPart(Supernodes nodes, std::vector<std::int64_t> row)
    : impl_(std::make_shared<const Impl>(
          Impl{.nodes = std::move(nodes), .rounded = {}, .row = std::move(row)})) {}

const std::vector<std::int64_t>& FactorPart::row() const {
  return impl_->row;
}

Eigen::Index FactorPart::size() const {
  return impl_->nodes.unknowns();
}

std::int64_t FactorPart::nonzeros() const {
  return impl_->nodes.nonzeros();
}

SupernodeView FactorPart::supernodes() const {
  return impl_->nodes.view();
}

void FactorPart::solve(SolveRows& X) const {
  impl_->nodes.solve(X);
}

void FactorPart::solve(Eigen::VectorXd& x) const {
  impl_->nodes.solve(x);
  if (!impl_->rounded.empty()) {
    x /= impl_->scale * impl_->scale;
  }
}

FactorPart FactorPart::rounded() const {
  auto part = std::make_shared<Impl>(*impl_);
  Supernodes& nodes = part->nodes;
  // L / scale in single precision, scale the largest pivot: numbers of any unit fit.
  // The solve gives scale^2 K^-1 b, which solve() divides by scale^2.
  part->scale = 0.0;
  for (std::size_t s = 0; s < nodes.count(); ++s) {
    for (std::ptrdiff_t j = 0; j < nodes.columns(s); ++j) {
      part->scale = std::max(part->scale, nodes.number[s][j * (nodes.rows(s) + 1)]);
    }
  }
  part->rounded.reserve(static_cast<std::size_t>(nodes.nonzeros() + kSolveWidth));
  for (std::size_t s = 0; s < nodes.count(); ++s) {
    nodes.rounded.push_back(part->rounded.data() + part->rounded.size());
    std::transform(nodes.number[s], nodes.number[s] + nodes.rows(s) * nodes.columns(s),
                   std::back_inserter(part->rounded), [&](double x) {
                     return static_cast<float>(x / part->scale);
                   });
  }
  part->rounded.resize(static_cast<std::size_t>(nodes.nonzeros() + kSolveWidth), 0.0F);
  FactorPart made;
  made.impl_ = std::move(part);
  return made;
}

}  // namespace palpate
