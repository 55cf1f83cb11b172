#include "precompute/fem/symbolic_factor.h"

#include <algorithm>
#include <mutex>

#include <cholmod.h>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/process/random_sequence.h"

namespace palpate {
namespace {

// Memory that CHOLMOD hands out, with the workspace that it needs to give it back.
struct Common {
  cholmod_common c{};
  Common() {
    cholmod_l_start(&c);
    c.supernodal = CHOLMOD_SUPERNODAL;
    c.nmethods = 1;
    c.method[0].ordering = CHOLMOD_METIS;
    c.print = 0;
  }
  ~Common() { cholmod_l_finish(&c); }
  Common(const Common&) = delete;
  Common& operator=(const Common&) = delete;
};

// CHOLMOD reads through pointers that are not const, and does not write to them.
template <typename T>
T* unwritten(const std::vector<T>& numbers) {
  return const_cast<T*>(
      numbers.data());  // NOLINT(cppcoreguidelines-pro-type-const-cast)
}

cholmod_sparse view(const LowerPattern& lower) {
  static_assert(sizeof(SuiteSparse_long) == sizeof(std::int64_t));
  cholmod_sparse A{};
  A.nrow = lower.begin.size() - 1;
  A.ncol = A.nrow;
  A.nzmax = lower.row.size();
  A.p = unwritten(lower.begin);
  A.i = unwritten(lower.row);
  A.stype = -1;
  A.itype = CHOLMOD_LONG;
  A.xtype = CHOLMOD_PATTERN;
  A.dtype = CHOLMOD_DOUBLE;
  A.sorted = 1;
  A.packed = 1;
  return A;
}

// Not in a child: a fork costs more than ordering a small body, a third of the time of
// presses on a thousand tets (MEASURED.md).
cholmod_factor* analysed(cholmod_sparse& A, cholmod_common& c) {
  const std::lock_guard lock(random_sequence_mutex());
  return cholmod_l_analyze(&A, &c);
}

template <typename To>
void copy(const void* from, std::size_t count, std::vector<To>& to) {
  const auto* numbers = static_cast<const SuiteSparse_long*>(from);
  to.resize(count);
  std::transform(numbers, numbers + count, to.begin(), [](SuiteSparse_long x) {
    return static_cast<To>(x);
  });
}

}  // namespace

SymbolicFactor symbolic_factor(const LowerPattern& pattern) {
  Common common;
  cholmod_sparse A = view(pattern);
  cholmod_factor* factor = analysed(A, common.c);
  if (factor == nullptr) {
    throw ResourceError(fmt::format(
        "the stiffness matrix of {} nodes could not be ordered: out of memory",
        A.nrow));
  }
  SymbolicFactor symbolic;
  copy(factor->Perm, factor->n, symbolic.order);
  copy(factor->super, factor->nsuper + 1, symbolic.begin);
  copy(factor->pi, factor->nsuper + 1, symbolic.row_begin);
  copy(factor->s, factor->ssize, symbolic.row);
  cholmod_l_free_factor(&factor, &common.c);
  return symbolic;
}

}  // namespace palpate
