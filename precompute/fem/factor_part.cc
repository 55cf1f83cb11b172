#include "precompute/fem/factor_part.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace palpate {

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
