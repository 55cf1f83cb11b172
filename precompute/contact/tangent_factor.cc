#include "precompute/contact/tangent_factor.h"

#include <algorithm>

#include "formats/base/error.h"

namespace palpate {
namespace {

// Adds blocks of near nodes to the lower triangle of K.
void add_blocks(const BlockMatrix& blocks, const std::vector<std::int64_t>& dof,
                Stiffness& K) {
  const auto add = [&](std::int64_t row, std::int64_t column, double value) {
    const std::int64_t* const begin = K.innerIndexPtr() + K.outerIndexPtr()[column];
    const std::int64_t* const end = K.innerIndexPtr() + K.outerIndexPtr()[column + 1];
    const std::int64_t* const at = std::lower_bound(begin, end, row);
    K.valuePtr()[at - K.innerIndexPtr()] += value;
  };
  // Free unknowns need not be numbered as near nodes are: an entry goes to the lower
  // triangle, whichever of its ends has the larger number.
  blocks.for_each([&](std::int32_t a, std::int32_t b, const double* block) {
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t i = a == b ? j : 0; i < 3; ++i) {
        const std::int64_t row = dof[3 * static_cast<std::size_t>(a) + i];
        const std::int64_t column = dof[3 * static_cast<std::size_t>(b) + j];
        if (row >= 0 && column >= 0) {
          add(std::max(row, column), std::min(row, column), block[3 * j + i]);
        }
      }
    }
  });
}

}  // namespace

void TangentFactor::refresh() {
  Stiffness K = stiffness_;
  add_blocks(near_.change(), near_.dof(), K);
  try {
    factor_.emplace(rest_.refactored(K));
  } catch (const NumericalError&) {
    return;
  }
  part_ = factor_->part(near_.dof());
  change_ = near_.change();
}

NearState TangentFactor::solve(const Eigen::VectorXd& r) const {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(part_.size());
  const std::vector<std::int64_t>& dof = near_.dof();
  const auto row = [&](std::size_t i) {
    return part_.row()[static_cast<std::size_t>(dof[i])];
  };
  for (std::size_t i = 0; i < dof.size(); ++i) {
    if (dof[i] >= 0) {
      x[row(i)] = r[static_cast<Eigen::Index>(i)];
    }
  }
  part_.solve(x);
  // (K + D) u = r, D the near field's change of stiffness. u = K^-1 (r - D u): the
  // pair's source is r - D u.
  NearState z{r, Eigen::VectorXd::Zero(r.size())};
  for (std::size_t i = 0; i < dof.size(); ++i) {
    if (dof[i] >= 0) {
      z.displacement_m[static_cast<Eigen::Index>(i)] = x[row(i)];
    }
  }
  Eigen::VectorXd changed = Eigen::VectorXd::Zero(r.size());
  change_.multiply_add(z.displacement_m, changed);
  z.source_n -= changed;
  near_.mask(z.source_n);
  return z;
}

}  // namespace palpate
