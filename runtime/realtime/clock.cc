#include "runtime/realtime/clock.h"

#include <cerrno>
#include <ctime>

namespace palpate {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

}  // namespace

std::int64_t MonotonicClock::now_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kSecond + now.tv_nsec;
}

void MonotonicClock::sleep_until_ns(std::int64_t deadline_ns) noexcept {
  const timespec until{.tv_sec = deadline_ns / kSecond,
                       .tv_nsec = deadline_ns % kSecond};
  // A signal handler may end the sleep early.
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace palpate
