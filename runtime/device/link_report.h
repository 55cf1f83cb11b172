// What a device's wire did, in numbers.
#pragma once

#include <cstdint>

#include "runtime/realtime/step_histogram.h"

namespace palpate {

struct LinkReport {
  std::int64_t transactions = 0;
  std::int64_t missed = 0;    ///< no whole answer in time
  std::int64_t silences = 0;  ///< times that the host's watchdog took the force away
  double duration_s = 0.0;
  StepHistogram time;  ///< of transactions
  /// Age of forces when the next one took their place. The age counts since the
  /// position that they answer was measured, or rather since the exchange began that
  /// brought it.
  StepHistogram force_age;

  /// [Hz] transactions with an answer.
  [[nodiscard]] double rate_hz() const noexcept {
    return duration_s > 0.0 ? static_cast<double>(transactions - missed) / duration_s
                            : 0.0;
  }
};

}  // namespace palpate
