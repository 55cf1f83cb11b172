#include "precompute/process/reused_memory.h"

#include <new>
#include <utility>

#include <sys/mman.h>

namespace palpate {
namespace {

constexpr std::size_t kLarge = 1 << 17;  // [doubles] a megabyte

void unmap(double* numbers, std::size_t doubles) noexcept {
  munmap(numbers, doubles * sizeof(double));
}

// What a thread keeps for its next array.
struct Spare {
  double* numbers = nullptr;
  std::size_t doubles = 0;
  ~Spare() {
    if (numbers != nullptr) {
      unmap(numbers, doubles);
    }
  }
};

Spare& spare() {
  thread_local Spare kept;
  return kept;
}

ReusedDoubles mapped(std::size_t count) {
  void* numbers = mmap(nullptr, count * sizeof(double), PROT_READ | PROT_WRITE,
                       MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (numbers == MAP_FAILED) {
    throw std::bad_alloc();
  }
  madvise(numbers, count * sizeof(double), MADV_DONTFORK);
  madvise(numbers, count * sizeof(double), MADV_HUGEPAGE);
  return {static_cast<double*>(numbers), ReusedMemoryDeleter{count}};
}

}  // namespace

void ReusedMemoryDeleter::operator()(double* numbers) const noexcept {
  if (doubles < kLarge) {
    delete[] numbers;
    return;
  }
  Spare& kept = spare();
  if (kept.doubles < doubles) {
    std::swap(kept.numbers, numbers);
    const std::size_t dropped = std::exchange(kept.doubles, doubles);
    if (numbers != nullptr) {
      unmap(numbers, dropped);
    }
    return;
  }
  unmap(numbers, doubles);
}

ReusedDoubles reused_doubles(std::size_t count) {
  if (count < kLarge) {
    return {new double[count], ReusedMemoryDeleter{count}};
  }
  Spare& kept = spare();
  if (kept.numbers != nullptr) {
    const std::size_t doubles = std::exchange(kept.doubles, 0);
    double* const numbers = std::exchange(kept.numbers, nullptr);
    if (doubles >= count && doubles / 2 <= count) {
      return {numbers, ReusedMemoryDeleter{doubles}};
    }
    unmap(numbers, doubles);
  }
  return mapped(count);
}

}  // namespace palpate
