#include "formats/report/stiffness_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/report/axis_ticks.h"

namespace palpate {
namespace {

void set_range(StiffnessMap& map) {
  const std::vector<std::int64_t>& order = map.softest_first;
  const auto at = [&](double part) {
    const double last = static_cast<double>(order.size() - 1);
    const auto node = order[static_cast<std::size_t>(std::lround(part * last))];
    return map.stiffness_n_per_m[static_cast<std::size_t>(node)];
  };
  map.low_n_per_m = at(0.02);
  map.high_n_per_m = at(0.98);
  // A homogeneous body must not show rounding as colours.
  const double least = std::max(0.1 * std::abs(map.high_n_per_m), 1e-9);
  const double missing = least - (map.high_n_per_m - map.low_n_per_m);
  if (missing > 0.0) {
    map.low_n_per_m -= missing / 2.0;
    map.high_n_per_m += missing / 2.0;
  }
  map.clipped_low = at(0.0) < map.low_n_per_m;
  map.clipped_high = at(1.0) > map.high_n_per_m;
}

}  // namespace

StiffnessMap stiffness_map(const ResponseTable& table) {
  StiffnessMap map;
  map.stiffness_n_per_m.assign(static_cast<std::size_t>(table.nodes()),
                               std::numeric_limits<double>::quiet_NaN());
  if (table.depth_m.empty()) {
    return map;
  }
  map.depth_m = round_down(table.depth_max_m() / 2.0 * (1.0 + 1e-9));
  for (std::int64_t node = 0; node < table.nodes(); ++node) {
    const CurveView curve = table.curve(node);
    if (!curve.depth_m.empty()) {
      map.stiffness_n_per_m[static_cast<std::size_t>(node)] =
          curve.at(map.depth_m).force_n / map.depth_m;
      map.softest_first.push_back(node);
    }
  }
  std::stable_sort(map.softest_first.begin(), map.softest_first.end(),
                   [&](std::int64_t a, std::int64_t b) {
                     return map.stiffness_n_per_m[static_cast<std::size_t>(a)] <
                            map.stiffness_n_per_m[static_cast<std::size_t>(b)];
                   });
  set_range(map);
  return map;
}

}  // namespace palpate
