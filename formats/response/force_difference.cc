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

std::vector<double> compared_depths_m(double end_m, const PlacedCurve& reference) {
  constexpr int kSteps = 90;
  const double last_m = std::min(end_m, reference.end_m());
  const double begin_m = kErrorCountsFrom * std::max(0.0, reference.end_m());
  std::vector<double> depth_m;
  for (int k = 0; k <= kSteps; ++k) {
    depth_m.push_back(begin_m + (last_m - begin_m) * k / kSteps);
  }
  return depth_m;
}

double force_difference(std::span<const double> depth_m, const Points& force_n,
                        const PlacedCurve& reference) {
  const double floor_n =
      kErrorCountsFrom *
      *std::max_element(reference.curve.force_n.begin(), reference.curve.force_n.end());
  double largest = 0.0;
  for (std::size_t k = 0; k < depth_m.size(); ++k) {
    const Eigen::Vector3d wanted_n = reference.force_n(depth_m[k]);
    const double off_n =
        (force_n.row(static_cast<Eigen::Index>(k)).transpose() - wanted_n).norm();
    if (off_n > 0.0) {
      largest = std::max(largest, off_n / std::max(wanted_n.norm(), floor_n));
    }
  }
  return largest;
}

double force_difference(const PlacedCurve& curve, const PlacedCurve& reference) {
  const bool has_none = curve.curve.depth_m.empty();
  if (has_none || reference.curve.depth_m.empty()) {
    return has_none == reference.curve.depth_m.empty() ? 0.0 : 1.0;
  }
  const std::vector<double> depth_m = compared_depths_m(curve.end_m(), reference);
  Points force_n(std::ssize(depth_m), 3);
  for (std::size_t k = 0; k < depth_m.size(); ++k) {
    force_n.row(static_cast<Eigen::Index>(k)) = curve.force_n(depth_m[k]).transpose();
  }
  return force_difference(depth_m, force_n, reference);
}

}  // namespace palpate
