#include "precompute/serve/hand_places.h"

#include <algorithm>

namespace palpate {

double distance_to_way_m(const HandPlace& hand,
                         const Eigen::Vector3d& point_m) noexcept {
  const Eigen::Vector3d way_m = kLookAheadS * hand.velocity_m_per_s;
  const Eigen::Vector3d from_hand_m = point_m - hand.position_m;
  const double squared = way_m.squaredNorm();
  const double along =
      squared > 0.0 ? std::clamp(from_hand_m.dot(way_m) / squared, 0.0, 1.0) : 0.0;
  return (from_hand_m - along * way_m).norm();
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
