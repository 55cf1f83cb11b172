#include "formats/response/force_difference.h"

#include <algorithm>
#include <cmath>

namespace palpate {

PlacedCurve placed_curve(const ResponseTable& table, std::int64_t node,
                         const Eigen::Vector3d& outward) {
  const auto i = static_cast<std::size_t>(node);
  const Eigen::Vector3d u = table.direction.row(node).transpose();
  PlacedCurve placed{table.curve(node), table.touch_offset_m[i],
                     std::abs(u.dot(outward)), u, outward};
  if (table.tilt.rows() > 0) {
    placed.tilt = tilt_line(table, node, outward);
  }
  if (!table.direction_begin.empty()) {
    const auto begin = static_cast<std::size_t>(table.direction_begin[i]);
    const auto end = static_cast<std::size_t>(table.direction_begin[i + 1]);
    placed.sample_direction = {table.sample_direction.data() + 3 * begin,
                               3 * (end - begin)};
  }
  return placed;
}

Eigen::Vector3d PlacedCurve::direction_at(double penetration_m) const noexcept {
  const double past_touch_m = penetration_m - touch_offset_m;
  if (tilt) {
    return tilted(outward, tilt->at(past_touch_m));
  }
  if (sample_direction.empty()) {
    return direction;
  }
  const double d = std::clamp(past_touch_m * along, 0.0, curve.depth_max_m());
  const std::size_t i = curve.interval(d);
  const double t = (d - curve.depth_m[i]) / (curve.depth_m[i + 1] - curve.depth_m[i]);
  const Eigen::Map<const Eigen::Vector3d> a(sample_direction.data() + 3 * i);
  const Eigen::Map<const Eigen::Vector3d> b(sample_direction.data() + 3 * (i + 1));
  return ((1.0 - t) * a + t * b).normalized();
}

double force_difference(const PlacedCurve& curve, const PlacedCurve& reference) {
  constexpr int kSteps = 90;
  const bool has_none = curve.curve.depth_m.empty();
  if (has_none || reference.curve.depth_m.empty()) {
    return has_none == reference.curve.depth_m.empty() ? 0.0 : 1.0;
  }
  const double end_m = std::min(curve.end_m(), reference.end_m());
  const double begin_m = kErrorCountsFrom * std::max(0.0, reference.end_m());
  const double floor_n =
      kErrorCountsFrom *
      *std::max_element(reference.curve.force_n.begin(), reference.curve.force_n.end());
  double largest = 0.0;
  for (int k = 0; k <= kSteps; ++k) {
    const double at_m = begin_m + (end_m - begin_m) * k / kSteps;
    const Eigen::Vector3d wanted_n = reference.force_n(at_m);
    const double off_n = (curve.force_n(at_m) - wanted_n).norm();
    if (off_n > 0.0) {
      largest = std::max(largest, off_n / std::max(wanted_n.norm(), floor_n));
    }
  }
  return largest;
}

}  // namespace palpate
