// The HDF5 library is not thread-safe, and prints: who calls it holds a lock. A build
// without HDF5 has the functions, which do nothing.
#pragma once

#include <mutex>

namespace palpate {

/// Switches HDF5's error printing off for its lifetime.
class QuietHdf5 {
 public:
  QuietHdf5();
  ~QuietHdf5();
  QuietHdf5(const QuietHdf5&) = delete;
  QuietHdf5& operator=(const QuietHdf5&) = delete;

 private:
  void* function_ = nullptr;
  void* data_ = nullptr;
};

/// That of all use of HDF5 in the process.
[[nodiscard]] std::recursive_mutex& hdf5_mutex();

/// Excludes all other use of HDF5 in the process. One thread can hold several. HDF5's
/// error printing is off meanwhile.
class Hdf5Lock {
 public:
  Hdf5Lock();

 private:
  std::lock_guard<std::recursive_mutex> guard_;
  QuietHdf5 quiet_;
};

/// The same, by hand, for hosts that use HDF5 themselves; they nest in one thread.
/// Their own error printing stays as it is.
void lock_hdf5();
void unlock_hdf5();

/// For programs that close all their files themselves, before their first use of HDF5:
/// switches its clean-up at exit off. After a damaged file HDF5 1.10 cannot finish it
/// and prints "infinite loop closing library" on stderr (known upstream; memory only).
void skip_hdf5_exit_cleanup() noexcept;

}  // namespace palpate
