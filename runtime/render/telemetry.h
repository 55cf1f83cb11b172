// What the fast process says of every tick: to a recorder, and to the flight recorder.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/recording/tick_record.h"
#include "runtime/realtime/spsc_ring.h"

namespace palpate {

/// From the fast thread to one reader.
using TickQueue = SpscRing<TickRecord, 8192>;

/// From the fast thread to whoever writes. When a queue is full the record is dropped
/// and counted: the fast thread never waits. About 1.2 MB; 4 s at 2 kHz.
struct Telemetry {
  TickQueue ticks;
  SpscRing<ArrivalRecord, 8192> arrivals;
};

/// The latest values; older ones are overwritten. Allocates when it is made.
template <typename T>
class LatestLog {
 public:
  explicit LatestLog(std::size_t capacity) : slot_(capacity) {}

  void add(const T& value) noexcept { slot_[added_++ % slot_.size()] = value; }

  /// Oldest first.
  [[nodiscard]] std::vector<T> values() const {
    std::vector<T> all;
    const std::size_t kept = std::min(added_, slot_.size());
    for (std::size_t i = added_ - kept; i < added_; ++i) {
      all.push_back(slot_[i % slot_.size()]);
    }
    return all;
  }

 private:
  std::vector<T> slot_;
  std::size_t added_ = 0;
};

/// The last ticks before a fault, kept in memory by the fast thread; to be read when it
/// has ended.
struct FlightLog {
  static constexpr std::size_t kTicks = 8192;  ///< 4 s at 2 kHz
  LatestLog<TickRecord> ticks{kTicks};
  LatestLog<ArrivalRecord> arrivals{kTicks};
};

}  // namespace palpate
