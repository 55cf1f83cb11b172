#include "precompute/fem/symbolic_factor.h"

#include <algorithm>
#include <limits>
#include <memory>
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

using Permutation = std::vector<SuiteSparse_long>;

// An order in postorder of the elimination tree, as supernodes need it, and what it
// costs.
struct Ordering {
  Permutation order;
  double cost = std::numeric_limits<double>::infinity();
};

// Multiplications for the factor, and for solves that touch the columns which the near
// unknowns reach. @param count non-zeros of each column.
double cost_of(const Permutation& count, const Permutation& parent,
               std::vector<char> reached) {
  // A guess: a group of linear presses has about as many columns, and a nonlinear press
  // some 200 solves alone, each of which takes as long as several columns.
  constexpr double kSolves = 2000.0;
  double cost = 0.0;
  for (std::size_t k = 0; k < count.size(); ++k) {
    const auto c = static_cast<double>(count[k]);
    cost += c * c;
    if (reached[k] != 0) {
      cost += kSolves * c;
      if (parent[k] >= 0) {
        reached[static_cast<std::size_t>(parent[k])] = 1;
      }
    }
  }
  return cost;
}

Ordering analysed_order(cholmod_sparse& A, Permutation order,
                        const std::vector<char>& is_near, cholmod_common& c) {
  const std::size_t n = A.nrow;
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
  std::vector<char> reached(n);
  for (std::size_t k = 0; k < n; ++k) {
    reached[k] = is_near[static_cast<std::size_t>(order[k])];
  }
  Ordering made{Permutation(n), cost_of(count, parent, std::move(reached))};
  std::transform(post.begin(), post.end(), made.order.begin(), [&](SuiteSparse_long i) {
    return order[static_cast<std::size_t>(i)];
  });
  return made;
}

// METIS' order, or the same with the near unknowns moved to the end, which makes the
// part small that they reach, but fills the factor: whichever costs less. Empty if
// CHOLMOD fails.
Permutation near_last(cholmod_sparse& A, std::span<const std::int32_t> near,
                      cholmod_common& c) {
  const std::size_t n = A.nrow;
  std::vector<char> is_near(n, 0);
  for (const std::int32_t i : near) {
    is_near[static_cast<std::size_t>(i)] = 1;
  }
  const auto far_first = [&](Permutation order) {
    std::stable_partition(order.begin(), order.end(), [&](SuiteSparse_long i) {
      return is_near[static_cast<std::size_t>(i)] == 0;
    });
    return order;
  };
  Permutation order(n);
  {
    const std::lock_guard lock(random_sequence_mutex());
    if (cholmod_l_metis(&A, nullptr, 0, 1, order.data(), &c) == 0) {
      return {};
    }
  }
  Ordering last = analysed_order(A, far_first(order), is_near, c);
  Ordering plain = analysed_order(A, std::move(order), is_near, c);
  return plain.cost < last.cost ? plain.order : far_first(std::move(last.order));
}

cholmod_factor* analysed(cholmod_sparse& A, std::span<const std::int32_t> near,
                         cholmod_common& c) {
  if (near.empty()) {
    const std::lock_guard lock(random_sequence_mutex());
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
