// Wall time of work, for reports and benchmarks.
#pragma once

#include <chrono>

namespace palpate {

/// [s]
[[nodiscard]] inline double seconds_since(std::chrono::steady_clock::time_point began) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began)
      .count();
}

/// What `work()` takes [s].
template <typename Work>
[[nodiscard]] double seconds_of(const Work& work) {
  const auto began = std::chrono::steady_clock::now();
  work();
  return seconds_since(began);
}

}  // namespace palpate
