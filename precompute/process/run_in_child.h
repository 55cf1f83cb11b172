// Runs a piece of work in a child process. So the caller goes on whatever the work does
// to its process: abort, exit, exhaust the memory, never end.
//
// A process that forks writes to a copy of each page that it touches afterwards. A new
// child asks the system for each page anew. A child that has done its work therefore
// waits for more.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace palpate {

struct ChildLimits {
  /// [s] (0, inf) of a processor: what is beside it does not count. One that gets so
  /// little that it takes twenty times as long is waiting for something.
  double time_s = 600.0;
  std::size_t memory_bytes = 8'000'000'000;  ///< more than the child holds already
};

struct ChildResult {
  bool done = false;      ///< the work returned, `bytes` is what it returned
  bool at_limit = false;  ///< not done because of a limit of time or memory
  std::string failure;    ///< else: why not, as the end of a sentence
  std::vector<char> bytes;
};

/// Knows no more of the caller than its input: what the caller's memory held when the
/// child was forked may be long past.
using ChildWork = std::vector<char> (*)(std::span<const char> input);

/// Runs `work` in a child process and returns what it returned. The child's output goes
/// to /dev/null; it dies with its parent. The memory limit is not set under sanitizers,
/// which reserve address space far beyond it.
/// A child that is killed (SIGKILL: for want of memory), and one that cannot be forked,
/// are tried again for kMomentS.
/// @throws ResourceError if that does not help, or it waited too long; Interrupted if
///   the child was ended by SIGINT or SIGTERM.
[[nodiscard]] ChildResult run_in_child(ChildWork work, std::span<const char> input,
                                       const ChildLimits& limits);

/// Forks children until so many are idle: early, while the caller holds little memory.
/// Where one cannot be forked, run_in_child() tries again.
void keep_children_ready(std::size_t count);

/// Ends idle children, whose time getrusage() counts then. For who ends by _exit();
/// exit() does it itself.
void end_idle_children();

}  // namespace palpate
