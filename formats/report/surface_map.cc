#include "formats/report/surface_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "formats/report/axis_ticks.h"
#include "formats/response/yielding.h"

namespace palpate {
namespace {

void set_range(SurfaceMap& map) {
  const std::vector<std::int64_t>& order = map.lowest_first;
  const auto at = [&](double part) {
    const double last = static_cast<double>(order.size() - 1);
    const auto node = order[static_cast<std::size_t>(std::lround(part * last))];
    return map.value[static_cast<std::size_t>(node)];
  };
  map.low = at(0.02);
  map.high = at(0.98);
  // A homogeneous body must not show rounding as colours.
  const double least = std::max(0.1 * std::abs(map.high), 1e-9);
  const double missing = least - (map.high - map.low);
  if (missing > 0.0) {
    map.low -= missing / 2.0;
    map.high += missing / 2.0;
  }
  map.clipped_low = at(0.0) < map.low;
  map.clipped_high = at(1.0) > map.high;
}

template <typename Value>
void set_values(const ResponseTable& table, const Value& value, SurfaceMap& map) {
  map.value.assign(static_cast<std::size_t>(table.nodes()),
                   std::numeric_limits<double>::quiet_NaN());
  for (std::int64_t node = 0; node < table.nodes(); ++node) {
    if (!table.curve(node).depth_m.empty()) {
      map.value[static_cast<std::size_t>(node)] = value(node);
      map.lowest_first.push_back(node);
    }
  }
  std::stable_sort(map.lowest_first.begin(), map.lowest_first.end(),
                   [&](std::int64_t a, std::int64_t b) {
                     return map.value[static_cast<std::size_t>(a)] <
                            map.value[static_cast<std::size_t>(b)];
                   });
  if (!map.lowest_first.empty()) {
    set_range(map);
  }
}

template <typename Value>
SurfaceMap node_map(const ResponseTable& table, const char* name, const char* unit,
                    const char* note, const Value& value) {
  SurfaceMap map;
  map.name = name;
  map.unit = unit;
  map.note = note;
  set_values(table, value, map);
  return map;
}

}  // namespace

double map_depth_m(double depth_max_m) {
  return depth_max_m > 0.0 ? round_down(depth_max_m / 2.0 * (1.0 + 1e-9)) : 1e-3;
}

SurfaceMap stiffness_map(const ResponseTable& table) {
  SurfaceMap map;
  if (!table.depth_m.empty()) {
    map.depth_m = map_depth_m(table.depth_max_m());
  }
  map.name = "stiffness [N/m]";
  map.unit = "N/m";
  map.note = fmt::format("f/d at {} mm", short_number(1e3 * map.depth_m));
  set_values(
      table,
      [&](std::int64_t node) {
        return table.curve(node).at(map.depth_m).force_n / map.depth_m;
      },
      map);
  return map;
}

SurfaceMap relaxation_map(const ResponseTable& table) {
  return node_map(table, "relaxes [%]", "%", "of a held force", [&](std::int64_t node) {
    return 100.0 * (1.0 - slow_share(table.viscoelasticity, node));
  });
}

SurfaceMap dent_map(const ResponseTable& table) {
  return node_map(
      table, "stays [%]", "%", "of what is past yielding", [&](std::int64_t node) {
        return 100.0 * yielding_of(table.viscoelasticity.yielding, node).share;
      });
}

SurfaceMap softening_map(const ResponseTable& table) {
  return node_map(table, "softens [%]", "%", "at most", [&](std::int64_t node) {
    return 100.0 * yielding_of(table.viscoelasticity.yielding, node).largest;
  });
}

SurfaceMap relaxation_time_map(const ResponseTable& table) {
  return node_map(table, "relaxes in [s]", "s", "mean of its times",
                  [&](std::int64_t node) {
                    return mean_time_s(table.viscoelasticity, node);
                  });
}

}  // namespace palpate
