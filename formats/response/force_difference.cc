#include "formats/response/force_difference.h"

#include <algorithm>
#include <cmath>

namespace palpate {

PlacedCurve placed_curve(const ResponseTable& table, std::int64_t node,
                         const Eigen::Vector3d& outward) {
  const auto i = static_cast<std::size_t>(node);
  return {table.curve(node), table.touch_offset_m[i],
          std::abs(table.direction.row(node).dot(outward.transpose()))};
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
    const double wanted_n = reference.force_n(at_m);
    const double off_n = std::abs(curve.force_n(at_m) - wanted_n);
    if (off_n > 0.0) {
      largest = std::max(largest, off_n / std::max(wanted_n, floor_n));
    }
  }
  return largest;
}

}  // namespace palpate
