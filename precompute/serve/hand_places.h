// Where hands are that wait for answers, and what is near their way.
#pragma once

#include <map>
#include <mutex>
#include <vector>

#include <Eigen/Core>

#include "formats/service/service_message.h"

namespace palpate {

/// [s] How far ahead a hand's way is looked at: 50 mm at 50 mm/s.
inline constexpr double kLookAheadS = 1.0;
/// [-] What a length of the way ahead counts against the same length aside or behind.
inline constexpr double kAheadCounts = 0.2;
/// [m/s] A hand that is slower rests: it waits for final answers where it is.
inline constexpr double kRestingMPerS = 0.01;

/// How little a point matters to a hand that keeps its velocity [m]. Each place on the
/// hand's way ahead counts with its distance to the point plus kAheadCounts times the
/// way to the place. The least of these is the value.
[[nodiscard]] double remoteness_m(const HandPlace& hand,
                                  const Eigen::Vector3d& point_m) noexcept;

/// The latest place of every hand. Safe from several threads.
class HandPlaces {
 public:
  void put(int who, const HandPlace& place);
  void remove(int who);
  [[nodiscard]] std::vector<HandPlace> all() const;

 private:
  mutable std::mutex mutex_;
  std::map<int, HandPlace> place_;
};

}  // namespace palpate
