#include <cerrno>
#include <ctime>

#include "runtime/realtime/clock.h"

namespace palpate {

std::int64_t MonotonicClock::now_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kSecondNs + now.tv_nsec;
}

void MonotonicClock::sleep_until_ns(std::int64_t deadline_ns) noexcept {
  const timespec until{.tv_sec = deadline_ns / kSecondNs,
                       .tv_nsec = deadline_ns % kSecondNs};
  // A signal handler may end the sleep early.
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace palpate
