#include "runtime/run/pressed_place.h"

#include <algorithm>

#include <fmt/format.h>

namespace palpate {

PressedPlace pressed_place(const SurfaceMesh& surface, std::int32_t row,
                           std::int32_t node,
                           const std::optional<Eigen::Vector3d>& at_m) {
  PressedPlace place{.node = node,
                     .position_m = surface.position_m.row(row).transpose(),
                     .edge_m = 0.0,
                     .off_m = std::nullopt};
  for (Eigen::Index t = 0; t < surface.triangle.rows(); ++t) {
    const auto corners = surface.triangle.row(t);
    if (!(corners.array() == row).any()) {
      continue;
    }
    for (const std::int32_t corner : corners) {
      place.edge_m = std::max(
          place.edge_m,
          (surface.position_m.row(corner).transpose() - place.position_m).norm());
    }
  }
  if (at_m) {
    place.off_m = (*at_m - place.position_m).norm();
  }
  return place;
}

std::string describe(const PressedPlace& place) {
  const Eigen::Vector3d& p = place.position_m;
  return fmt::format(
      "node {} at ({:.4g}, {:.4g}, {:.4g}) m{}", place.node, p.x(), p.y(), p.z(),
      place.off_m
          ? fmt::format(", {:.3g} mm from the place asked for", 1e3 * *place.off_m)
          : "");
}

std::string far_note(const PressedPlace& place) {
  return place.is_far()
             ? fmt::format(
                   "the place asked for is {:.3g} mm from node {}, the nearest with a "
                   "response, whose edges are {:.3g} mm at most: --at takes metres, "
                   "and "
                   "places on the surface",
                   1e3 * *place.off_m, place.node, 1e3 * place.edge_m)
             : "";
}

}  // namespace palpate
