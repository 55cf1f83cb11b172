#include <chrono>

#include <windows.h>

#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

constexpr std::int64_t kTimerTickNs = 100;

// Wakes within half a millisecond (Windows 10 1803 on); the usual timer's 16 ms before.
HANDLE new_timer() {
  constexpr DWORD kHighResolution = 2;  // CREATE_WAITABLE_TIMER_HIGH_RESOLUTION
  const HANDLE fine =
      CreateWaitableTimerExW(nullptr, nullptr, kHighResolution, TIMER_ALL_ACCESS);
  return fine != nullptr
             ? fine
             : CreateWaitableTimerExW(nullptr, nullptr, 0, TIMER_ALL_ACCESS);
}

struct ThreadTimer {
  ThreadTimer() = default;
  ~ThreadTimer() { CloseHandle(handle); }
  ThreadTimer(const ThreadTimer&) = delete;
  ThreadTimer& operator=(const ThreadTimer&) = delete;
  const HANDLE handle = new_timer();
};

}  // namespace

std::int64_t MonotonicClock::now_ns() noexcept {
  using std::chrono::steady_clock;
  return std::chrono::nanoseconds(steady_clock::now().time_since_epoch()).count();
}

void MonotonicClock::sleep_until_ns(std::int64_t deadline_ns) noexcept {
  thread_local const ThreadTimer timer;
  for (std::int64_t left = deadline_ns - now_ns(); left > 0;
       left = deadline_ns - now_ns()) {
    LARGE_INTEGER due{};
    due.QuadPart = -(left + kTimerTickNs - 1) / kTimerTickNs;  // below zero: from now
    if (SetWaitableTimer(timer.handle, &due, 0, nullptr, nullptr, FALSE) == 0) {
      Sleep(1);
    } else {
      WaitForSingleObject(timer.handle, INFINITE);
    }
  }
}

}  // namespace palpate
