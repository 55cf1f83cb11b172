// A clock that stands still, jumps where it is told, and oversleeps on purpose.
#pragma once

#include <cstdint>
#include <map>

#include "runtime/realtime/clock.h"

namespace palpate {

/// One thread. Sleeping moves it to the deadline, plus what oversleep() says.
class FakeClock : public Clock {
 public:
  explicit FakeClock(std::int64_t start_ns = 0) : now_ns_(start_ns) {}

  /// The sleep with this number (from 0) ends so much too late.
  void oversleep(int sleep, std::int64_t late_ns) { late_ns_[sleep] = late_ns; }

  [[nodiscard]] std::int64_t now_ns() noexcept override { return now_ns_; }

  void sleep_until_ns(std::int64_t deadline_ns) noexcept override {
    now_ns_ = deadline_ns > now_ns_ ? deadline_ns : now_ns_;
    const auto late = late_ns_.find(sleeps_++);
    now_ns_ += late != late_ns_.end() ? late->second : 0;
  }

  [[nodiscard]] int sleeps() const noexcept { return sleeps_; }

 private:
  std::int64_t now_ns_;
  int sleeps_ = 0;
  std::map<int, std::int64_t> late_ns_;
};

}  // namespace palpate
