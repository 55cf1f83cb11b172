#include "tests/support/allocation_guard.h"

#include <cstddef>
#include <cstdlib>
#include <new>

namespace palpate::test {
namespace {

// Plain thread-locals: no constructor that could allocate on first use.
thread_local bool counting = false;
thread_local std::uint64_t allocations = 0;

}  // namespace

AllocationGuard::AllocationGuard() noexcept {
  allocations = 0;
  counting = true;
}

AllocationGuard::~AllocationGuard() {
  counting = false;
}

std::uint64_t AllocationGuard::count() const noexcept {
  return allocations;
}

void note_allocation() noexcept {
  if (counting) {
    ++allocations;
  }
}

}  // namespace palpate::test

// A sanitizer owns malloc, and other C libraries have no second name for theirs: there
// operator new alone is counted, on top of malloc.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__GLIBC__)

namespace {

void* counted_new(std::size_t size) {
  palpate::test::note_allocation();
  void* memory = std::malloc(size > 0 ? size : 1);
  if (memory == nullptr) {
    throw std::bad_alloc();
  }
  return memory;
}

}  // namespace

void* operator new(std::size_t size) {
  return counted_new(size);
}
void* operator new[](std::size_t size) {
  return counted_new(size);
}
void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
  palpate::test::note_allocation();
  return std::malloc(size > 0 ? size : 1);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}

#else

// glibc's own allocator under its documented replacement names: operator new, Eigen and
// C code all end in these.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): glibc's
// names.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

void* malloc(std::size_t size) {
  palpate::test::note_allocation();
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) {
  palpate::test::note_allocation();
  return __libc_calloc(count, size);
}

void* realloc(void* memory, std::size_t size) {
  palpate::test::note_allocation();
  return __libc_realloc(memory, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  palpate::test::note_allocation();
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** memory, std::size_t alignment, std::size_t size) noexcept {
  palpate::test::note_allocation();
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? 12 : 0;  // ENOMEM
}
}

#endif
