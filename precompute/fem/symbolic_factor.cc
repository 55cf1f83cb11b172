#include "precompute/fem/symbolic_factor.h"

#include <algorithm>
#include <memory>
#include <mutex>

#include <cholmod.h>
#include <fmt/format.h>

#include "formats/base/error.h"

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

// METIS draws from the process's one random sequence: two orderings at a time would
// share it out between them by chance.
std::mutex& ordering_mutex() {
  static std::mutex mutex;
  return mutex;
}

using Permutation = std::vector<SuiteSparse_long>;

// METIS' order with the near unknowns moved to the end, and both parts in postorder of
// the elimination tree, as supernodes need it. Empty if CHOLMOD fails.
Permutation near_last(cholmod_sparse& A, std::span<const std::int32_t> near,
                      cholmod_common& c) {
  const std::size_t n = A.nrow;
  std::vector<char> is_near(n, 0);
  for (const std::int32_t i : near) {
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

cholmod_factor* analysed(cholmod_sparse& A, std::span<const std::int32_t> near,
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

template <typename To>
void copy(const void* from, std::size_t count, std::vector<To>& to) {
  const auto* numbers = static_cast<const SuiteSparse_long*>(from);
  to.resize(count);
  std::transform(numbers, numbers + count, to.begin(), [](SuiteSparse_long x) {
    return static_cast<To>(x);
  });
}

}  // namespace

SymbolicFactor symbolic_factor(const LowerPattern& pattern,
                               std::span<const std::int32_t> near) {
  Common common;
  cholmod_sparse A = view(pattern);
  cholmod_factor* factor = analysed(A, near, common.c);
  if (factor == nullptr) {
    throw NumericalError(fmt::format(
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
