// A hand that runs beside the library's slow thread.
#pragma once

#include <chrono>
#include <thread>

namespace palpate {

/// A tenth of a millisecond: some systems do not sleep for so short a time.
inline void pause_between_ticks() {
  using std::chrono::steady_clock;
  constexpr std::chrono::microseconds kPause{100};
  const steady_clock::time_point end = steady_clock::now() + kPause;
  do {
    std::this_thread::sleep_for(kPause);
  } while (steady_clock::now() < end);
}

}  // namespace palpate
