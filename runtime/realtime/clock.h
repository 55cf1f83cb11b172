// The clock that a render loop runs by: real time, or time that only the loop advances.
#pragma once

#include <cmath>
#include <cstdint>

namespace palpate {

constexpr double kNanosecondsPerSecond = 1e9;
constexpr std::int64_t kSecondNs = 1'000'000'000;  ///< one second [ns], whole

[[nodiscard]] constexpr double seconds_in(std::int64_t duration_ns) noexcept {
  return static_cast<double>(duration_ns) / kNanosecondsPerSecond;
}

/// The nearest whole number.
[[nodiscard]] inline std::int64_t nanoseconds_in(double duration_s) noexcept {
  return std::llround(duration_s * kNanosecondsPerSecond);
}

/// A seam: real loops sleep, simulated ones jump, tests oversleep on purpose.
class Clock {
 public:
  Clock() = default;
  virtual ~Clock() = default;
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;

  /// [ns] since an arbitrary start; never goes back.
  [[nodiscard]] virtual std::int64_t now_ns() noexcept = 0;

  /// Returns at `deadline_ns` or later; at once if it has passed.
  virtual void sleep_until_ns(std::int64_t deadline_ns) noexcept = 0;
};

/// CLOCK_MONOTONIC with absolute deadlines (clock_nanosleep); any number of threads.
class MonotonicClock : public Clock {
 public:
  [[nodiscard]] std::int64_t now_ns() noexcept override;
  void sleep_until_ns(std::int64_t deadline_ns) noexcept override;
};

/// Starts at 0 and stands still except while somebody sleeps; one thread.
class SimulatedClock : public Clock {
 public:
  [[nodiscard]] std::int64_t now_ns() noexcept override { return now_ns_; }
  void sleep_until_ns(std::int64_t deadline_ns) noexcept override {
    now_ns_ = deadline_ns > now_ns_ ? deadline_ns : now_ns_;
  }

 private:
  std::int64_t now_ns_ = 0;
};

}  // namespace palpate
