// What the operating system grants a thread that must not be late.
#pragma once

#include <string>

namespace palpate {

struct RealTimeGrant {
  bool fifo_scheduling = false;  ///< the calling thread runs under SCHED_FIFO
  bool memory_locked = false;    ///< no page of the process can be swapped out
  std::string remark;            ///< one line: what was granted, what was not and why
};

/// Asks SCHED_FIFO for the calling thread and locks the process's memory. What is not
/// permitted is left as it is and named; never throws.
[[nodiscard]] RealTimeGrant request_real_time();

}  // namespace palpate
