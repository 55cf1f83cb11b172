#include "runtime/hand/hand_tape.h"

namespace palpate {

void HandTape::record() {
  *this = HandTape();
  recording_ = true;
}

void HandTape::play() noexcept {
  next_ = 0;
  playing_ = true;
}

void HandTape::stop(std::int64_t tick) noexcept {
  if (recording_) {
    ticks_ = tick;
  }
  recording_ = false;
  playing_ = false;
}

void HandTape::add(const HandWish& wish) {
  if (!recording_) {
    return;
  }
  wishes_.push_back(wish);
  if (wishes_.size() >= kMost) {
    stop(wish.tick);
  }
}

std::int64_t HandTape::next_tick() const noexcept {
  return next_ < wishes_.size() ? wishes_[next_].tick : ticks_;
}

std::optional<HandWish> HandTape::take(std::int64_t tick) noexcept {
  if (!playing_ || tick < next_tick()) {
    return std::nullopt;
  }
  if (next_ == wishes_.size()) {
    playing_ = false;
    return std::nullopt;
  }
  return wishes_[next_++];
}

}  // namespace palpate
