#include "precompute/serve/hand_places.h"

#include <algorithm>
#include <cmath>

namespace palpate {

// With a the distance from the way's line and x along it, the least of
// sqrt(a^2 + (x - s)^2) + c s over s lies where (x - s) = c a / sqrt(1 - c^2).
double remoteness_m(const HandPlace& hand, const Eigen::Vector3d& point_m) noexcept {
  const Eigen::Vector3d from_hand_m = point_m - hand.position_m;
  const double way_m = kLookAheadS * hand.velocity_m_per_s.norm();
  if (!(way_m > 0.0)) {
    return from_hand_m.norm();
  }
  const Eigen::Vector3d ahead = hand.velocity_m_per_s.normalized();
  const double along_m = from_hand_m.dot(ahead);
  const double aside_m = (from_hand_m - along_m * ahead).norm();
  const double back_m =
      kAheadCounts * aside_m / std::sqrt(1.0 - kAheadCounts * kAheadCounts);
  const double s_m = std::clamp(along_m - back_m, 0.0, way_m);
  return std::hypot(aside_m, along_m - s_m) + kAheadCounts * s_m;
}

void HandPlaces::put(int who, const HandPlace& place) {
  const std::lock_guard lock(mutex_);
  place_[who] = place;
}

void HandPlaces::remove(int who) {
  const std::lock_guard lock(mutex_);
  place_.erase(who);
}

std::vector<HandPlace> HandPlaces::all() const {
  const std::lock_guard lock(mutex_);
  std::vector<HandPlace> places;
  for (const auto& [who, place] : place_) {
    places.push_back(place);
  }
  return places;
}

}  // namespace palpate
