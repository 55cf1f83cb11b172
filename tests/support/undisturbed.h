// What depends on the wall clock, measured while the machine kept time.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

namespace palpate {

/// The longest time by which a thread that sleeps for a millisecond woke up late while
/// `run` ran. [s]
template <typename Run>
double longest_pause_s(const Run& run) {
  using Steady = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kSleep(1);
  std::atomic<bool> stop = false;
  std::chrono::duration<double> longest{0.0};
  {
    const std::jthread watch([&] {
      for (auto slept = Steady::now(); !stop;) {
        std::this_thread::sleep_for(kSleep);
        const auto now = Steady::now();
        longest =
            std::max<std::chrono::duration<double>>(longest, now - slept - kSleep);
        slept = now;
      }
    });
    run();
    stop = true;
  }
  return longest.count();
}

/// Runs again where the machine paused, at most six times; what the last run left is
/// what counts.
template <typename Run>
void undisturbed(const Run& run, double pause_s = 0.02) {
  for (int tries = 0; tries < 6 && longest_pause_s(run) > pause_s; ++tries) {
  }
}

}  // namespace palpate
