// What a pointer did, by ticks: to be done again, the same to the bit, while the body
// is rendered in another way.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace palpate {

/// A wish of a hand, made before the tick of that number.
struct HandWish {
  std::int64_t tick = 0;
  bool hold = false;
  Eigen::Vector3d target_m = Eigen::Vector3d::Zero();  ///< [m] if hold
  int hand = 0;                                        ///< -1: all of them
  /// Body frame from the tool's frame, if hold; none: as it is.
  std::optional<Eigen::Quaterniond> turn = {};
};

/// Empty, being recorded, recorded, or being played. Ticks count from the start of the
/// run in which it is recorded or played.
class HandTape {
 public:
  static constexpr std::size_t kMost = 100'000;  ///< wishes: half an hour of a page

  void record();
  void play() noexcept;  ///< from its start; not empty
  /// Ends recording or playing. @param tick length of what is recorded.
  void stop(std::int64_t tick) noexcept;

  void add(const HandWish& wish);

  [[nodiscard]] bool recording() const noexcept { return recording_; }
  [[nodiscard]] bool playing() const noexcept { return playing_; }
  [[nodiscard]] bool empty() const noexcept { return wishes_.empty(); }

  /// While playing: the tick before which something is due, a wish or the end.
  [[nodiscard]] std::int64_t next_tick() const noexcept;

  /// The next wish, once its tick has come; none before, and at the end, which stops.
  [[nodiscard]] std::optional<HandWish> take(std::int64_t tick) noexcept;

  [[nodiscard]] std::int64_t ticks() const noexcept { return ticks_; }

 private:
  std::vector<HandWish> wishes_;
  std::int64_t ticks_ = 0;
  std::size_t next_ = 0;
  bool recording_ = false;
  bool playing_ = false;
};

}  // namespace palpate
