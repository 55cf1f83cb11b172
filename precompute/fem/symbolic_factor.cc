#include "precompute/fem/symbolic_factor.h"

#include <algorithm>
#include <csignal>
#include <cstring>
#include <span>

#include <cholmod.h>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/process/run_in_child.h"

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

// Arrays one after another, each behind its length.
template <typename To>
void append_row(const void* from, std::size_t count, std::vector<char>& bytes) {
  const auto* numbers = static_cast<const SuiteSparse_long*>(from);
  std::vector<To> row(count);
  std::transform(numbers, numbers + count, row.begin(), [](SuiteSparse_long x) {
    return static_cast<To>(x);
  });
  const auto* length = reinterpret_cast<const char*>(&count);
  bytes.insert(bytes.end(), length, length + sizeof(count));
  const auto* first = reinterpret_cast<const char*>(row.data());
  bytes.insert(bytes.end(), first, first + count * sizeof(To));
}

template <typename To>
void take_row(std::span<const char>& bytes, std::vector<To>& to) {
  std::size_t count = 0;
  std::memcpy(&count, bytes.data(), sizeof(count));
  to.resize(count);
  std::memcpy(to.data(), bytes.data() + sizeof(count), count * sizeof(To));
  bytes = bytes.subspan(sizeof(count) + count * sizeof(To));
}

// METIS jumps out of whatever it does when SIGTERM comes, and returns as if it had done
// it: the signal waits until it has.
class HeldSigterm {
 public:
  HeldSigterm() {
    sigset_t held;
    sigemptyset(&held);
    sigaddset(&held, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &held, &before_);
  }
  ~HeldSigterm() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  HeldSigterm(const HeldSigterm&) = delete;
  HeldSigterm& operator=(const HeldSigterm&) = delete;

 private:
  sigset_t before_{};
};

// Nothing where memory does not suffice.
std::vector<char> ordered(const LowerPattern& pattern) {
  const HeldSigterm held;
  Common common;
  cholmod_sparse A = view(pattern);
  cholmod_factor* factor = cholmod_l_analyze(&A, &common.c);
  std::vector<char> bytes;
  if (factor != nullptr) {
    append_row<std::int32_t>(factor->Perm, factor->n, bytes);
    append_row<std::int32_t>(factor->super, factor->nsuper + 1, bytes);
    append_row<std::int64_t>(factor->pi, factor->nsuper + 1, bytes);
    append_row<std::int32_t>(factor->s, factor->ssize, bytes);
    cholmod_l_free_factor(&factor, &common.c);
  }
  return bytes;
}

}  // namespace

// METIS draws from the C library's one sequence of random numbers, and sets handlers of
// signals for the whole process: in a process of its own it disturbs nobody.
SymbolicFactor symbolic_factor(const LowerPattern& pattern) {
  const ChildResult child = run_in_child(
      [&] {
        return ordered(pattern);
      },
      {});
  const std::size_t nodes = pattern.begin.size() - 1;
  if (!child.done) {
    throw NumericalError(
        fmt::format("the stiffness matrix of {} nodes could not be ordered: {}", nodes,
                    child.failure));
  }
  if (child.bytes.empty()) {
    throw ResourceError(fmt::format(
        "the stiffness matrix of {} nodes could not be ordered: out of memory", nodes));
  }
  SymbolicFactor symbolic;
  std::span<const char> bytes = child.bytes;
  take_row(bytes, symbolic.order);
  take_row(bytes, symbolic.begin);
  take_row(bytes, symbolic.row_begin);
  take_row(bytes, symbolic.row);
  return symbolic;
}

}  // namespace palpate
