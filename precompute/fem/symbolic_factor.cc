#include "precompute/fem/symbolic_factor.h"

#include <algorithm>
#include <span>
#include <string>

#include <cholmod.h>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/process/packed_bytes.h"
#include "precompute/process/run_in_child.h"

namespace palpate {
namespace {

constexpr double kLongest = 86'400.0;                   // [s] a large body takes long
constexpr std::size_t kMostMemory = 1'000'000'000'000;  // the machine's, that is

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

cholmod_sparse view(LowerPattern& lower) {
  static_assert(sizeof(SuiteSparse_long) == sizeof(std::int64_t));
  cholmod_sparse A{};
  A.nrow = lower.begin.size() - 1;
  A.ncol = A.nrow;
  A.nzmax = lower.row.size();
  A.p = lower.begin.data();
  A.i = lower.row.data();
  A.stype = -1;
  A.itype = CHOLMOD_LONG;
  A.xtype = CHOLMOD_PATTERN;
  A.dtype = CHOLMOD_DOUBLE;
  A.sorted = 1;
  A.packed = 1;
  return A;
}

template <typename To>
void append_as(std::vector<char>& bytes, const void* from, std::size_t count) {
  const auto* numbers = static_cast<const SuiteSparse_long*>(from);
  std::vector<To> to(count);
  std::transform(numbers, numbers + count, to.begin(), [](SuiteSparse_long x) {
    return static_cast<To>(x);
  });
  append_bytes(bytes, to);
}

// Nothing if the memory did not suffice.
std::vector<char> analysed(std::span<const char> input) {
  LowerPattern pattern;
  take_bytes(input, pattern.begin);
  take_bytes(input, pattern.row);
  Common common;
  cholmod_sparse A = view(pattern);
  cholmod_factor* factor = cholmod_l_analyze(&A, &common.c);
  std::vector<char> bytes;
  if (factor != nullptr) {
    append_as<std::int32_t>(bytes, factor->Perm, factor->n);
    append_as<std::int32_t>(bytes, factor->super, factor->nsuper + 1);
    append_as<std::int64_t>(bytes, factor->pi, factor->nsuper + 1);
    append_as<std::int32_t>(bytes, factor->s, factor->ssize);
    cholmod_l_free_factor(&factor, &common.c);
  }
  return bytes;
}

}  // namespace

// In a child: METIS draws from the C library's one sequence of random numbers, which
// two orderings at a time would share out between them by chance.
SymbolicFactor symbolic_factor(const LowerPattern& pattern) {
  std::vector<char> input;
  append_bytes(input, pattern.begin);
  append_bytes(input, pattern.row);
  const ChildResult result =
      run_in_child(analysed, input, {.time_s = kLongest, .memory_bytes = kMostMemory});
  const std::string failed =
      fmt::format("the stiffness matrix of {} nodes could not be ordered",
                  pattern.begin.size() - 1);
  if (!result.done) {
    throw NumericalError(fmt::format("{}: {}", failed, result.failure));
  }
  if (result.bytes.empty()) {
    throw ResourceError(failed + ": out of memory");
  }
  SymbolicFactor symbolic;
  std::span<const char> bytes = result.bytes;
  take_bytes(bytes, symbolic.order);
  take_bytes(bytes, symbolic.begin);
  take_bytes(bytes, symbolic.row_begin);
  take_bytes(bytes, symbolic.row);
  return symbolic;
}

}  // namespace palpate
