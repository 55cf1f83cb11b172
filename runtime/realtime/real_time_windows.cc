#include <fmt/format.h>
#include <windows.h>

#include "runtime/realtime/real_time.h"

namespace palpate {

RealTimeGrant request_real_time(int cpu) {
  RealTimeGrant grant;
  const HANDLE self = GetCurrentThread();
  const bool first = SetThreadPriority(self, THREAD_PRIORITY_TIME_CRITICAL) != 0;
  constexpr int kCpusMax = 64;  // of a processor group
  grant.pinned = cpu >= 0 && cpu < kCpusMax &&
                 SetThreadAffinityMask(self, DWORD_PTR{1} << cpu) != 0;
  grant.remark = fmt::format(
      "{}, memory not locked (Windows locks no process whole){}",
      first ? "time-critical priority (Windows has no SCHED_FIFO)" : "usual priority",
      cpu < 0 ? ", on any CPU"
              : fmt::format(", {} CPU {}", grant.pinned ? "on" : "not kept on", cpu));
  return grant;
}

void request_slow_real_time() noexcept {
  SetThreadPriority(GetCurrentThread(), THREAD_PRIORITY_ABOVE_NORMAL);
}

}  // namespace palpate
