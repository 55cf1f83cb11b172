#include "precompute/fem/cholesky_factor.h"

#include <algorithm>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "formats/base/at.h"
#include "formats/base/error.h"
#include "precompute/fem/permuted_stiffness.h"
#include "precompute/fem/symbolic_factor.h"
#include "precompute/lanes/factor_kernels.h"
#include "precompute/process/machine_memory.h"
#include "precompute/process/reused_memory.h"

namespace palpate {
namespace {

// What the columns of a supernode's descendants take out of it, and which they are.
class Descendants {
 public:
  Descendants(const SymbolicFactor& symbolic, std::ptrdiff_t block)
      : symbolic_(symbolic),
        block_(block),
        head_(symbolic.begin.size() - 1, -1),
        next_(symbolic.begin.size() - 1, -1),
        position_(symbolic.begin.size() - 1, 0),
        supernode_(symbolic.order.size()) {
    for (std::size_t s = 0; s + 1 < symbolic.begin.size(); ++s) {
      std::fill(supernode_.begin() + symbolic.begin[s],
                supernode_.begin() + symbolic.begin[s + 1],
                static_cast<std::int32_t>(s));
    }
  }

  // @param local as PermutedStiffness::add_to's.
  void update(std::size_t s, const Supernodes& factor,
              const std::vector<std::int32_t>& local, double* numbers) {
    for (std::int32_t d = head_[s]; d >= 0;) {
      const std::int32_t after = next_[at(d)];
      update_by(at(d), s, factor, local, numbers);
      wait(at(d));
      d = after;
    }
    position_[s] = symbolic_.begin[s + 1] - symbolic_.begin[s];
    wait(s);
  }

 private:
  // Hands a supernode to the one that holds its next row.
  void wait(std::size_t d) {
    const std::int64_t next = symbolic_.row_begin[d] + position_[d];
    if (next < symbolic_.row_begin[d + 1]) {
      const auto s = at(supernode_[at(symbolic_.row[at(next)])]);
      next_[d] = head_[s];
      head_[s] = static_cast<std::int32_t>(d);
    }
  }

  void update_by(std::size_t d, std::size_t s, const Supernodes& factor,
                 const std::vector<std::int32_t>& local, double* numbers) {
    const std::int32_t* const row = symbolic_.row.data() + symbolic_.row_begin[d];
    const std::int64_t rows = symbolic_.row_begin[d + 1] - symbolic_.row_begin[d];
    const std::int64_t first = position_[d];
    std::int64_t last = first;
    while (last < rows && row[last] < symbolic_.begin[s + 1]) {
      ++last;
    }
    position_[d] = last;
    // C = L_1 L_2^T: L_1 are d's rows from `first` on, L_2 those of them that are
    // columns of s.
    const FactorKernels& kernels = factor_kernels();
    const std::ptrdiff_t m = (rows - first) * block_;
    const std::ptrdiff_t n = (last - first) * block_;
    const std::ptrdiff_t k = factor.columns(d);
    const std::ptrdiff_t ldc = kernels.product_rows(m);
    double* const C = factor_space(ldc * n + kernels.product_work(m, n, k));
    const double* const L = factor.number[d] + first * block_;
    kernels.product(m, n, k, L, factor.rows(d), L, factor.rows(d), C, ldc, true,
                    C + ldc * n);
    const std::ptrdiff_t ld = factor.rows(s);
    // s loses C where its own rows lie.
    for (std::int64_t j = first; j < last; ++j) {
      for (std::ptrdiff_t b = 0; b < block_; ++b) {
        const double* const from = C + ((j - first) * block_ + b) * ldc;
        double* const to =
            numbers + (std::ptrdiff_t{row[j] - symbolic_.begin[s]} * block_ + b) * ld;
        for (std::int64_t i = j; i < rows; ++i) {
          for (std::ptrdiff_t a = 0; a < block_; ++a) {
            to[std::ptrdiff_t{local[at(row[i])]} * block_ + a] -=
                from[(i - first) * block_ + a];
          }
        }
      }
    }
  }

  const SymbolicFactor& symbolic_;
  std::ptrdiff_t block_;
  std::vector<std::int32_t> head_, next_;  // lists of those that wait for a supernode
  std::vector<std::int64_t> position_;     // first row that has not been used yet
  std::vector<std::int32_t> supernode_;    // of each block of columns
};

}  // namespace

struct CholeskyFactor::Impl {
  std::ptrdiff_t block = 1;
  std::shared_ptr<const SymbolicFactor> symbolic;
  std::vector<std::int32_t> order;  // unknown that is eliminated k-th
  ReusedDoubles number;
  Supernodes nodes;

  // Of `symbolic`.
  void make_structure();
  void make_room();
  void factorise(const Stiffness& lower);
};

void CholeskyFactor::Impl::make_structure() {
  for (const std::int32_t i : symbolic->order) {
    for (std::ptrdiff_t b = 0; b < block; ++b) {
      order.push_back(static_cast<std::int32_t>(i * block + b));
    }
  }
  for (const std::int32_t column : symbolic->begin) {
    nodes.begin.push_back(static_cast<std::int32_t>(column * block));
  }
  nodes.row_begin.clear();
  for (const std::int64_t begin : symbolic->row_begin) {
    nodes.row_begin.push_back(begin * block);
  }
  for (const std::int32_t row : symbolic->row) {
    for (std::ptrdiff_t b = 0; b < block; ++b) {
      nodes.row.push_back(static_cast<std::int32_t>(row * block + b));
    }
  }
  nodes.number.resize(symbolic->begin.size() - 1);
}

void CholeskyFactor::Impl::make_room() {
  const std::int64_t count = nodes.nonzeros();
  const double bytes = sizeof(double) * static_cast<double>(count);
  // The system grants what it does not have, and kills who then uses it.
  require_free_memory(bytes, bytes,
                      fmt::format("the factor of {} unknowns", order.size()),
                      "solve parts of the body ([cutout] radius_m), use a coarser "
                      "surface or a lower contact_resolution");
  number = reused_doubles(at(count + kSolveWidth));
  std::fill_n(number.get() + count, kSolveWidth, 0.0);
  std::int64_t next = 0;
  for (std::size_t s = 0; s < nodes.count(); ++s) {
    nodes.number[s] = number.get() + next;
    next += nodes.rows(s) * nodes.columns(s);
  }
}

void CholeskyFactor::Impl::factorise(const Stiffness& lower) {
  const PermutedStiffness K(lower, block, symbolic->order);
  Descendants descendants(*symbolic, block);
  const FactorKernels& kernels = factor_kernels();
  std::vector<std::int32_t> local(symbolic->order.size());
  double smallest = std::numeric_limits<double>::infinity();
  double largest = 0.0;
  double* numbers = number.get();
  // Left-looking (Ng, Peyton 1993), for each supernode of m rows and k columns:
  // 1. Its columns of K.
  // 2. Minus the products L_d L_d^T of its descendants d.
  // 3. A dense factor of what is left.
  for (std::size_t s = 0; s < nodes.count(); ++s) {
    const std::ptrdiff_t m = nodes.rows(s);
    const std::ptrdiff_t k = nodes.columns(s);
    for (auto i = symbolic->row_begin[s]; i < symbolic->row_begin[s + 1]; ++i) {
      local[at(symbolic->row[at(i)])] =
          static_cast<std::int32_t>(i - symbolic->row_begin[s]);
    }
    std::fill(numbers, numbers + m * k, 0.0);
    K.add_to(symbolic->begin[s], symbolic->begin[s + 1], local, numbers, m);
    descendants.update(s, nodes, local, numbers);
    if (kernels.factorise(m, k, numbers, m,
                          factor_space(kernels.factorise_work(m, k))) < k) {
      smallest = 0.0;
      break;
    }
    for (std::ptrdiff_t j = 0; j < k; ++j) {
      smallest = std::min(smallest, numbers[j + j * m]);
      largest = std::max(largest, numbers[j + j * m]);
    }
    numbers += m * k;
  }
  // An unsupported body is singular only to rounding: its pivots do not reach zero.
  constexpr double kSingular = 1e-7;
  if (!(smallest > kSingular * largest)) {
    throw NumericalError(
        "the stiffness matrix is singular: no support holds the body, or it holds it "
        "in fewer than three points that are not in a line");
  }
}

CholeskyFactor::CholeskyFactor(const Stiffness& lower)
    : impl_(std::make_unique<Impl>()) {
  impl_->block = block_size(lower);
  impl_->symbolic = std::make_shared<const SymbolicFactor>(
      symbolic_factor(pattern_of(lower, impl_->block)));
  impl_->make_structure();
  impl_->make_room();
  impl_->factorise(lower);
}

CholeskyFactor::CholeskyFactor(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

CholeskyFactor CholeskyFactor::refactored(const Stiffness& lower) const {
  auto made = std::make_unique<Impl>();
  made->block = impl_->block;
  made->symbolic = impl_->symbolic;
  made->order = impl_->order;
  made->nodes = impl_->nodes;
  made->make_room();
  made->factorise(lower);
  return CholeskyFactor(std::move(made));
}

CholeskyFactor::~CholeskyFactor() = default;
CholeskyFactor::CholeskyFactor(CholeskyFactor&&) noexcept = default;
CholeskyFactor& CholeskyFactor::operator=(CholeskyFactor&&) noexcept = default;

FactorPart CholeskyFactor::part(std::span<const std::int64_t> unknowns) const {
  const Supernodes& whole = impl_->nodes;
  const std::size_t n = impl_->order.size();
  std::vector<std::int32_t> column(n);
  for (std::size_t k = 0; k < n; ++k) {
    column[at(impl_->order[k])] = static_cast<std::int32_t>(k);
  }
  const auto supernode_of = [&](std::int32_t c) {
    return at(std::upper_bound(whole.begin.begin(), whole.begin.end(), c) -
              whole.begin.begin() - 1);
  };
  // A load on a column fills only that column's ancestors in the elimination tree. The
  // part is therefore the supernodes of the unknowns and all their parents.
  std::vector<char> reached(whole.count(), 0);
  for (const std::int64_t unknown : unknowns) {
    if (unknown >= 0) {
      reached[supernode_of(column[at(unknown)])] = 1;
    }
  }
  Supernodes nodes;
  std::vector<std::int64_t> row_of(n, -1);
  std::vector<std::int32_t> now(n, -1);  // columns in the part
  std::int32_t size = 0;
  for (std::size_t s = 0; s < whole.count(); ++s) {
    if (reached[s] == 0) {
      continue;
    }
    const std::span rows(whole.row.data() + whole.row_begin[s], at(whole.rows(s)));
    if (whole.rows(s) > whole.columns(s)) {  // the parent
      reached[supernode_of(rows[at(whole.columns(s))])] = 1;
    }
    nodes.begin.push_back(size);
    nodes.number.push_back(whole.number[s]);
    nodes.row.insert(nodes.row.end(), rows.begin(), rows.end());
    nodes.row_begin.push_back(static_cast<std::int64_t>(nodes.row.size()));
    for (std::int32_t c = whole.begin[s]; c < whole.begin[s + 1]; ++c) {
      row_of[at(impl_->order[at(c)])] = size;
      now[at(c)] = size++;
    }
  }
  nodes.begin.push_back(size);
  for (std::int32_t& r : nodes.row) {
    r = now[at(r)];
  }
  return {std::move(nodes), std::move(row_of)};
}

std::int64_t CholeskyFactor::size() const {
  return static_cast<std::int64_t>(impl_->order.size());
}

std::int64_t CholeskyFactor::factor_nonzeros() const {
  return impl_->nodes.nonzeros();
}

Eigen::MatrixXd CholeskyFactor::solve(const Eigen::MatrixXd& B) const {
  const std::vector<std::int32_t>& order = impl_->order;
  // X = P^T (L L^T)^-1 P B, P the order of elimination; at most kSolveWidthMax columns
  // at once.
  Eigen::MatrixXd X(B.rows(), B.cols());
  if (B.cols() == 1) {
    Eigen::VectorXd x = B.col(0)(order);
    impl_->nodes.solve(x);
    X.col(0)(order) = x;
    return X;
  }
  SolveRows rows;
  for (Eigen::Index first = 0; first < B.cols(); first += kSolveWidthMax) {
    const Eigen::Index count = std::min(kSolveWidthMax, B.cols() - first);
    rows.setZero(B.rows(), solve_width(count));
    for (Eigen::Index i = 0; i < B.rows(); ++i) {
      rows.row(i).head(count) = B.row(order[at(i)]).segment(first, count);
    }
    impl_->nodes.solve(rows);
    for (Eigen::Index i = 0; i < B.rows(); ++i) {
      X.row(order[at(i)]).segment(first, count) = rows.row(i).head(count);
    }
  }
  return X;
}

}  // namespace palpate
