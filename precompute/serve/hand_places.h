// Where hands are that wait for answers, and what is near their way.
#pragma once

#include <map>
#include <mutex>
#include <vector>

#include <Eigen/Core>

#include "formats/service/service_message.h"

namespace palpate {

/// [s] How far ahead a hand's way is looked at: a hand at 50 mm/s is 15 mm further
/// then, and a cheap answer for its neighbourhood takes about as long.
inline constexpr double kLookAheadS = 0.3;

/// Distance [m] of a point to the way that a hand will go if it keeps its velocity.
[[nodiscard]] double distance_to_way_m(const HandPlace& hand,
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
