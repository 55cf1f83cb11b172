#include "precompute/surface/surface_distance.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "formats/mesh/surface_search.h"

namespace palpate {

double distance_to_surface_m(const SurfaceMesh& from, const SurfaceMesh& to) {
  const SurfaceSearch target(to);
  std::vector<bool> asked(static_cast<std::size_t>(from.position_m.rows()), false);
  double largest_m = 0.0;
  const auto ask = [&](const Eigen::RowVector3d& p_m) {
    largest_m = std::max(largest_m, target.nearest(p_m.transpose()).distance_m);
  };
  for (const auto corner : from.triangle.rowwise()) {
    ask(from.position_m(corner, Eigen::all).colwise().mean());
    for (const std::int32_t v : corner) {
      if (!asked[static_cast<std::size_t>(v)]) {
        asked[static_cast<std::size_t>(v)] = true;
        ask(from.position_m.row(v));
      }
    }
  }
  return largest_m;
}

}  // namespace palpate
