// A row of absolute deadlines at a fixed rate.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "runtime/realtime/clock.h"

namespace palpate {

/// Deadline k is start + k / rate, rounded to ns, so that no error adds up.
class Deadlines {
 public:
  /// The first deadline is at start_ns. @param rate_hz [Hz] > 0.
  Deadlines(std::int64_t start_ns, double rate_hz) noexcept
      : start_ns_(start_ns), period_ns_(kNanosecondsPerSecond / rate_hz) {}

  [[nodiscard]] std::int64_t next_ns() const noexcept {
    return start_ns_ + std::llround(static_cast<double>(index_) * period_ns_);
  }

  /// The work of the present deadline begins at now_ns >= next_ns(). Goes on to the
  /// first deadline after it. @returns deadlines that were skipped, 0 when in time.
  std::int64_t begin(std::int64_t now_ns) noexcept {
    const double late_ns = static_cast<double>(now_ns - next_ns());
    const auto skipped =
        std::max<std::int64_t>(0, static_cast<std::int64_t>(late_ns / period_ns_));
    index_ += 1 + skipped;
    return skipped;
  }

 private:
  std::int64_t start_ns_;
  double period_ns_;
  std::int64_t index_ = 0;
};

}  // namespace palpate
