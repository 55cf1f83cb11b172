// Runs a piece of work in a child process, so that whatever it does to the process -
// abort, exit, exhaust the memory, never end - the caller goes on.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace palpate {

struct ChildLimits {
  /// [s] (0, inf) of a processor: what is beside it does not count. One that gets so
  /// little that it takes twenty times as long is waiting for something.
  double time_s = 600.0;
  std::size_t memory_bytes = 8'000'000'000;  ///< more than the caller holds already
};

struct ChildResult {
  bool done = false;      ///< the work returned, `bytes` is what it returned
  bool at_limit = false;  ///< not done because of a limit of time or memory
  std::string failure;    ///< else: why not, as the end of a sentence
  std::vector<char> bytes;
};

/// Forks, runs `work` there, and returns what it returned. The child's output goes to
/// /dev/null; it dies with its parent. The memory limit is not set under sanitizers,
/// which reserve address space far beyond it.
/// A child that is killed (SIGKILL: for want of memory), and one that cannot be forked,
/// are tried again for kMomentS.
/// @throws ResourceError if that does not help, or it waited too long; Interrupted if
///   the child was ended by SIGINT or SIGTERM.
[[nodiscard]] ChildResult run_in_child(const std::function<std::vector<char>()>& work,
                                       const ChildLimits& limits);

}  // namespace palpate
