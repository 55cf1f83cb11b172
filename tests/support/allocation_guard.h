// Counts heap allocations, to prove that a piece of code makes none.
//
// A program that uses this replaces malloc, calloc, realloc, aligned_alloc and
// posix_memalign, in which operator new ends, too; under a sanitizer operator new only.
// Counting is per thread and only while a guard lives.
#pragma once

#include <cstdint>

namespace palpate::test {

/// While it lives, every allocation of its thread is counted. Guards do not nest.
class AllocationGuard {
 public:
  AllocationGuard() noexcept;
  ~AllocationGuard();
  AllocationGuard(const AllocationGuard&) = delete;
  AllocationGuard& operator=(const AllocationGuard&) = delete;

  /// Allocations since the guard was made.
  [[nodiscard]] std::uint64_t count() const noexcept;
};

/// Counts one, if a guard lives in this thread.
void note_allocation() noexcept;

}  // namespace palpate::test
