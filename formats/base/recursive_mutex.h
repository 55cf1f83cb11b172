// A mutex that one thread may lock several times; of a machine without threads, none.
#pragma once

#include <mutex>

namespace palpate {

#if defined(__wasm__) && !defined(_REENTRANT)
struct RecursiveMutex {
  void lock() noexcept {}
  void unlock() noexcept {}
};
#else
using RecursiveMutex = std::recursive_mutex;
#endif

using RecursiveLock = std::lock_guard<RecursiveMutex>;

}  // namespace palpate
