// Without an operating system nobody else runs while one waits.
#include <chrono>

#include "runtime/realtime/clock.h"

namespace palpate {

std::int64_t MonotonicClock::now_ns() noexcept {
  using std::chrono::steady_clock;
  return std::chrono::nanoseconds(steady_clock::now().time_since_epoch()).count();
}

void MonotonicClock::sleep_until_ns(std::int64_t deadline_ns) noexcept {
  while (now_ns() < deadline_ns) {
  }
}

}  // namespace palpate
