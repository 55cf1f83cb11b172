// Large arrays that are made and dropped over and over.
//
// A new array of many pages costs a page fault for each of them, and every fork copies
// what maps the pages (run_in_child). Arrays of this kind are kept for the next array
// of the same thread. Children do not see them, and the system may give them pages of
// two megabytes.
#pragma once

#include <cstddef>
#include <memory>

namespace palpate {

struct ReusedMemoryDeleter {
  std::size_t doubles = 0;
  void operator()(double* numbers) const noexcept;
};
using ReusedDoubles = std::unique_ptr<double[], ReusedMemoryDeleter>;

/// Room for so many doubles, not set to anything; not to be used in a child process.
/// Small arrays are as others. A thread keeps one array that was dropped, if it is not
/// more than twice as large as the next that is asked for. @throws std::bad_alloc
[[nodiscard]] ReusedDoubles reused_doubles(std::size_t count);

}  // namespace palpate
