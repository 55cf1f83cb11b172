#include "precompute/fem/cholesky_factor.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>

#include <cholmod.h>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/process/machine_memory.h"

// OpenBLAS; its own header is not needed for one call.
extern "C" void openblas_set_num_threads(int threads);
// OpenMP's; null where CHOLMOD was built without.
extern "C" [[gnu::weak]] void omp_set_max_active_levels(int levels);

namespace palpate {
namespace {

// Keeps libraries from starting threads of their own under the calling one: ours run
// over nodes and over blocks of right-hand sides, and CHOLMOD wakes four for each
// supernode, which costs more than they do. OpenMP keeps the setting by thread.
void stay_on_this_thread() {
  thread_local bool done = false;
  if (!done) {
    openblas_set_num_threads(1);
    if (omp_set_max_active_levels != nullptr) {
      omp_set_max_active_levels(0);
    }
    done = true;
  }
}

// Memory that CHOLMOD hands out, with the workspace that it needs to give it back.
struct Common {
  cholmod_common c{};
  Common() {
    stay_on_this_thread();
    cholmod_l_start(&c);
    c.supernodal = CHOLMOD_SUPERNODAL;
    c.final_ll = 1;
    c.nmethods = 1;
    c.method[0].ordering = CHOLMOD_METIS;
    c.print = 0;
  }
  ~Common() { cholmod_l_finish(&c); }
  Common(const Common&) = delete;
  Common& operator=(const Common&) = delete;
};

cholmod_sparse view(const Stiffness& lower) {
  // CHOLMOD reads through pointers that are not const, and does not write to them.
  auto* K =
      const_cast<Stiffness*>(&lower);  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  cholmod_sparse A{};
  A.nrow = static_cast<std::size_t>(lower.rows());
  A.ncol = static_cast<std::size_t>(lower.cols());
  A.nzmax = static_cast<std::size_t>(lower.nonZeros());
  A.p = K->outerIndexPtr();
  A.i = K->innerIndexPtr();
  A.x = K->valuePtr();
  A.stype = -1;
  A.itype = CHOLMOD_LONG;
  A.xtype = CHOLMOD_REAL;
  A.dtype = CHOLMOD_DOUBLE;
  A.sorted = 1;
  A.packed = 1;
  return A;
}

// METIS draws from the process's one random sequence: two orderings at a time would
// share it out between them by chance.
std::mutex& ordering_mutex() {
  static std::mutex mutex;
  return mutex;
}

using Permutation = std::vector<SuiteSparse_long>;

// METIS' order with the near unknowns moved to the end, and both parts in postorder of
// the elimination tree, as supernodes need it. Empty if CHOLMOD fails.
Permutation near_last(cholmod_sparse& A, std::span<const std::int64_t> near,
                      cholmod_common& c) {
  const std::size_t n = A.nrow;
  std::vector<char> is_near(n, 0);
  for (const std::int64_t i : near) {
    is_near[static_cast<std::size_t>(i)] = 1;
  }
  const auto far_first = [&](Permutation& order) {
    std::stable_partition(order.begin(), order.end(), [&](SuiteSparse_long i) {
      return is_near[static_cast<std::size_t>(i)] == 0;
    });
  };
  Permutation order(n);
  {
    const std::lock_guard lock(ordering_mutex());
    if (cholmod_l_metis(&A, nullptr, 0, 1, order.data(), &c) == 0) {
      return {};
    }
  }
  far_first(order);
  Permutation parent(n);
  Permutation post(n);
  Permutation count(n);
  Permutation first(n);
  Permutation level(n);
  if (cholmod_l_analyze_ordering(&A, CHOLMOD_GIVEN, order.data(), nullptr, 0,
                                 parent.data(), post.data(), count.data(), first.data(),
                                 level.data(), &c) == 0) {
    return {};
  }
  Permutation ordered(n);
  std::transform(post.begin(), post.end(), ordered.begin(), [&](SuiteSparse_long i) {
    return order[static_cast<std::size_t>(i)];
  });
  far_first(ordered);
  return ordered;
}

cholmod_factor* analyse(cholmod_sparse& A, std::span<const std::int64_t> near,
                        cholmod_common& c) {
  if (near.empty()) {
    const std::lock_guard lock(ordering_mutex());
    return cholmod_l_analyze(&A, &c);
  }
  Permutation order = near_last(A, near, c);
  if (order.empty()) {
    return nullptr;
  }
  c.method[0].ordering = CHOLMOD_GIVEN;
  c.postorder = 0;
  return cholmod_l_analyze_p(&A, order.data(), nullptr, 0, &c);
}

Eigen::MatrixXd solved(cholmod_factor* factor, const Eigen::MatrixXd& B) {
  thread_local Common common;  // a workspace per thread; the factor is only read
  cholmod_dense b{};
  b.nrow = static_cast<std::size_t>(B.rows());
  b.ncol = static_cast<std::size_t>(B.cols());
  b.nzmax = b.nrow * b.ncol;
  b.d = b.nrow;
  b.x = const_cast<double*>(B.data());  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  cholmod_dense* x = cholmod_l_solve(CHOLMOD_A, factor, &b, &common.c);
  if (x == nullptr) {
    throw NumericalError(
        fmt::format("out of memory in a solve with {} right-hand sides", B.cols()));
  }
  Eigen::MatrixXd X =
      Eigen::Map<const Eigen::MatrixXd>(static_cast<double*>(x->x), B.rows(), B.cols());
  cholmod_l_free_dense(&x, &common.c);
  return X;
}

template <typename Index>
std::span<const SuiteSparse_long> indices(const void* numbers, Index count) {
  return {static_cast<const SuiteSparse_long*>(numbers),
          static_cast<std::size_t>(count)};
}

// A factor's supernodes and their arrays.
struct Supernodes {
  explicit Supernodes(const cholmod_factor& f)
      : begin(indices(f.super, f.nsuper + 1)),
        row_begin(indices(f.pi, f.nsuper + 1)),
        number_begin(indices(f.px, f.nsuper + 1)),
        row(indices(f.s, f.ssize)) {}

  [[nodiscard]] SuiteSparse_long columns(std::size_t k) const {
    return begin[k + 1] - begin[k];
  }
  [[nodiscard]] std::span<const SuiteSparse_long> rows(std::size_t k) const {
    return row.subspan(static_cast<std::size_t>(row_begin[k]),
                       static_cast<std::size_t>(row_begin[k + 1] - row_begin[k]));
  }
  // The supernode of a column.
  [[nodiscard]] std::size_t of(SuiteSparse_long column) const {
    return static_cast<std::size_t>(
        std::upper_bound(begin.begin(), begin.end(), column) - begin.begin() - 1);
  }

  std::span<const SuiteSparse_long> begin, row_begin, number_begin, row;
};

}  // namespace

// A factor of its own that shares the whole one's numbers: supernodes that contain all
// their ancestors, so that no row of theirs is missing.
struct FactorPart::Impl {
  cholmod_factor factor{};
  std::vector<SuiteSparse_long> super, pi, px, s, perm;
  std::vector<std::int64_t> row;
  std::int64_t nonzeros = 0;

  // Makes the factor of these supernodes; numbers and settings are the whole one's.
  void share(const cholmod_factor& whole) {
    perm.resize(static_cast<std::size_t>(super.back()));
    std::iota(perm.begin(), perm.end(), SuiteSparse_long{0});
    factor = whole;
    factor.n = perm.size();
    factor.minor = factor.n;
    factor.nsuper = super.size() - 1;
    factor.ssize = s.size();
    factor.super = super.data();
    factor.pi = pi.data();
    factor.px = px.data();
    factor.s = s.data();
    factor.Perm = perm.data();
    factor.IPerm = nullptr;
    factor.ordering = CHOLMOD_NATURAL;
  }
};

struct CholeskyFactor::Impl {
  Common common;
  cholmod_factor* factor = nullptr;
  ~Impl() { cholmod_l_free_factor(&factor, &common.c); }
};

CholeskyFactor::CholeskyFactor(const Stiffness& lower,
                               std::span<const std::int64_t> near)
    : impl_(std::make_unique<Impl>()) {
  cholmod_common& c = impl_->common.c;
  cholmod_sparse A = view(lower);
  impl_->factor = analyse(A, near, c);
  if (impl_->factor == nullptr) {
    throw NumericalError(fmt::format(
        "the stiffness matrix of {} unknowns could not be ordered: out of memory",
        lower.rows()));
  }
  const double bytes = sizeof(double) * static_cast<double>(impl_->factor->xsize);
  // The system grants what it does not have, and kills who then uses it.
  if (const auto free = static_cast<double>(free_memory_bytes()); bytes > free) {
    throw NumericalError(fmt::format(
        "the factor of {} unknowns takes {:.3g} GB, {:.3g} GB are free: solve parts of "
        "the body ([cutout] radius_m), use a coarser surface or a lower "
        "contact_resolution",
        lower.rows(), 1e-9 * bytes, 1e-9 * free));
  }
  cholmod_l_factorize(&A, impl_->factor, &c);
  if (c.status == CHOLMOD_OUT_OF_MEMORY) {
    throw NumericalError(fmt::format(
        "out of memory while factorising the stiffness matrix of {} unknowns; use a "
        "coarser surface or a lower contact_resolution",
        lower.rows()));
  }
  // An unsupported body is singular only to rounding: its pivots do not reach zero.
  const double reciprocal_condition = cholmod_l_rcond(impl_->factor, &c);
  if (c.status != CHOLMOD_OK || !(reciprocal_condition > 1e-14)) {
    throw NumericalError(
        "the stiffness matrix is singular: no support holds the body, or it holds it "
        "in "
        "fewer than three points that are not in a line");
  }
}

FactorPart CholeskyFactor::part(std::span<const std::int64_t> unknowns) const {
  const cholmod_factor& whole = *impl_->factor;
  const Supernodes nodes(whole);
  const auto order = indices(whole.Perm, whole.n);
  std::vector<SuiteSparse_long> column(whole.n);
  for (std::size_t k = 0; k < whole.n; ++k) {
    column[static_cast<std::size_t>(order[k])] = static_cast<SuiteSparse_long>(k);
  }
  std::vector<char> reached(whole.nsuper, 0);
  for (const std::int64_t unknown : unknowns) {
    if (unknown >= 0) {
      reached[nodes.of(column[static_cast<std::size_t>(unknown)])] = 1;
    }
  }
  auto part = std::make_shared<FactorPart::Impl>();
  part->row.assign(whole.n, -1);
  std::vector<SuiteSparse_long> now(whole.n, -1);  // columns in the part
  SuiteSparse_long size = 0;
  for (std::size_t k = 0; k < whole.nsuper; ++k) {
    if (reached[k] == 0) {
      continue;
    }
    const auto rows = nodes.rows(k);
    const SuiteSparse_long columns = nodes.columns(k);
    if (rows.size() > static_cast<std::size_t>(columns)) {  // the parent
      reached[nodes.of(rows[static_cast<std::size_t>(columns)])] = 1;
    }
    part->super.push_back(size);
    part->pi.push_back(static_cast<SuiteSparse_long>(part->s.size()));
    part->px.push_back(nodes.number_begin[k]);
    part->s.insert(part->s.end(), rows.begin(), rows.end());
    part->nonzeros += columns * static_cast<SuiteSparse_long>(rows.size());
    for (SuiteSparse_long c = nodes.begin[k]; c < nodes.begin[k + 1]; ++c) {
      part->row[static_cast<std::size_t>(order[static_cast<std::size_t>(c)])] = size;
      now[static_cast<std::size_t>(c)] = size++;
    }
  }
  part->super.push_back(size);
  part->pi.push_back(static_cast<SuiteSparse_long>(part->s.size()));
  part->px.push_back(nodes.number_begin.back());
  for (SuiteSparse_long& r : part->s) {
    r = now[static_cast<std::size_t>(r)];
  }
  part->share(whole);
  FactorPart made;
  made.impl_ = std::move(part);
  return made;
}

const std::vector<std::int64_t>& FactorPart::row() const {
  return impl_->row;
}

Eigen::Index FactorPart::size() const {
  return static_cast<Eigen::Index>(impl_->factor.n);
}

std::int64_t FactorPart::nonzeros() const {
  return impl_->nonzeros;
}

Eigen::MatrixXd FactorPart::solve(const Eigen::MatrixXd& B) const {
  // CHOLMOD reads through a pointer that is not const, and does not write to it.
  return solved(
      const_cast<cholmod_factor*>(  // NOLINT(cppcoreguidelines-pro-type-const-cast)
          &impl_->factor),
      B);
}

CholeskyFactor::~CholeskyFactor() = default;
CholeskyFactor::CholeskyFactor(CholeskyFactor&&) noexcept = default;
CholeskyFactor& CholeskyFactor::operator=(CholeskyFactor&&) noexcept = default;

std::int64_t CholeskyFactor::size() const {
  return static_cast<std::int64_t>(impl_->factor->n);
}

std::int64_t CholeskyFactor::factor_nonzeros() const {
  return static_cast<std::int64_t>(impl_->factor->xsize);
}

Eigen::MatrixXd CholeskyFactor::solve(const Eigen::MatrixXd& B) const {
  return solved(impl_->factor, B);
}

}  // namespace palpate
