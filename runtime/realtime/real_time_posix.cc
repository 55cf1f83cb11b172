#include <cerrno>
#include <system_error>

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include "runtime/realtime/real_time.h"

namespace palpate {
namespace {

constexpr int kPriority = 80;  // of 1..99: above everything ordinary, below watchdogs

std::string reason(int error) {
  return std::generic_category().message(error);
}

std::string pin(int cpu, bool& pinned) {
  if (cpu < 0) {
    return ", on any CPU";
  }
  cpu_set_t cpus;
  CPU_ZERO(&cpus);
  if (cpu < CPU_SETSIZE) {
    CPU_SET(static_cast<std::size_t>(cpu), &cpus);
  }
  const int error = pthread_setaffinity_np(pthread_self(), sizeof cpus, &cpus);
  pinned = error == 0;
  return pinned ? fmt::format(", on CPU {}", cpu)
                : fmt::format(", not kept on CPU {} ({})", cpu, reason(error));
}

}  // namespace

RealTimeGrant request_real_time(int cpu) {
  RealTimeGrant grant;
  const sched_param priority{.sched_priority = kPriority};
  const int scheduling = pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority);
  grant.fifo_scheduling = scheduling == 0;
  grant.remark = grant.fifo_scheduling
                     ? fmt::format("SCHED_FIFO at priority {}", kPriority)
                     : fmt::format(
                           "no SCHED_FIFO ({}; allow it with an rtprio limit of "
                           "{} or CAP_SYS_NICE)",
                           reason(scheduling), kPriority);
  const int locking = mlockall(MCL_CURRENT | MCL_FUTURE) == 0 ? 0 : errno;
  grant.memory_locked = locking == 0;
  grant.remark += grant.memory_locked
                      ? ", memory locked"
                      : fmt::format(
                            ", memory not locked ({}; allow it with a memlock "
                            "limit or CAP_IPC_LOCK)",
                            reason(locking));
  grant.remark += pin(cpu, grant.pinned);
  return grant;
}

void request_slow_real_time() noexcept {
  const sched_param priority{.sched_priority = kPriority / 2};
  pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority);
}

}  // namespace palpate
