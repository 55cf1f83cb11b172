// What the operating system grants a thread that must not be late.
#pragma once

#include <string>

namespace palpate {

struct RealTimeGrant {
  bool fifo_scheduling = false;  ///< the calling thread runs under SCHED_FIFO
  bool memory_locked = false;    ///< no page of the process can be swapped out
  bool pinned = false;           ///< the calling thread stays on the CPU asked for
  std::string remark;            ///< one line: what was granted, what was not and why
};

/// Asks SCHED_FIFO for the calling thread, locks the process's memory, and keeps the
/// thread on `cpu`; -1 leaves it free. What is not permitted is left as it is and
/// named.
[[nodiscard]] RealTimeGrant request_real_time(int cpu = -1);

/// Asks SCHED_FIFO for the calling thread at half that priority, for the slow process:
/// above everything ordinary, below the fast thread. Not granted where the above is
/// not.
void request_slow_real_time() noexcept;

}  // namespace palpate
