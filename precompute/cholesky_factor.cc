#include "precompute/cholesky_factor.h"

#include <cmath>
#include <mutex>

#include <cholmod.h>
#include <fmt/format.h>

#include "formats/error.h"
#include "precompute/machine_memory.h"

// OpenBLAS; its own header is not needed for one call.
extern "C" void openblas_set_num_threads(int threads);

namespace palpate {
namespace {

// Memory that CHOLMOD hands out, with the workspace that it needs to give it back.
struct Common {
  cholmod_common c{};
  Common() {
    // Threads run over blocks of right-hand sides: a second level inside BLAS only
    // costs.
    openblas_set_num_threads(1);
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

}  // namespace

struct CholeskyFactor::Impl {
  Common common;
  cholmod_factor* factor = nullptr;
  ~Impl() { cholmod_l_free_factor(&factor, &common.c); }
};

CholeskyFactor::CholeskyFactor(const Stiffness& lower)
    : impl_(std::make_unique<Impl>()) {
  cholmod_common& c = impl_->common.c;
  cholmod_sparse A = view(lower);
  {
    // METIS draws from the process's one random sequence: two orderings at a time would
    // share it out between them by chance.
    static std::mutex ordering;
    const std::lock_guard lock(ordering);
    impl_->factor = cholmod_l_analyze(&A, &c);
  }
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
  thread_local Common common;  // a workspace per thread; the factor is only read
  cholmod_dense b{};
  b.nrow = static_cast<std::size_t>(B.rows());
  b.ncol = static_cast<std::size_t>(B.cols());
  b.nzmax = b.nrow * b.ncol;
  b.d = b.nrow;
  b.x = const_cast<double*>(B.data());  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  cholmod_dense* x = cholmod_l_solve(CHOLMOD_A, impl_->factor, &b, &common.c);
  if (x == nullptr) {
    throw NumericalError(
        fmt::format("out of memory in a solve with {} right-hand sides", B.cols()));
  }
  Eigen::MatrixXd X =
      Eigen::Map<const Eigen::MatrixXd>(static_cast<double*>(x->x), B.rows(), B.cols());
  cholmod_l_free_dense(&x, &common.c);
  return X;
}

}  // namespace palpate
