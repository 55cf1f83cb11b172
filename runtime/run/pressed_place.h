// Which node a hand presses, and how far it lies from the place asked for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

struct PressedPlace {
  std::int32_t node = -1;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< [m] of the node
  double edge_m = 0.0;  ///< [m] longest edge of the node's triangles
  std::optional<double>
      off_m;  ///< [m] of the node from the place asked for; none: no place was

  /// Farther from the place asked for than the longest edge: the place is not on the
  /// surface, or not where nodes have responses.
  [[nodiscard]] bool is_far() const { return off_m && *off_m > edge_m; }
};

/// @param row of the node in `surface`. @param node its number in the whole body.
/// @param at_m [m] the place asked for.
[[nodiscard]] PressedPlace pressed_place(const SurfaceMesh& surface, std::int32_t row,
                                         std::int32_t node,
                                         const std::optional<Eigen::Vector3d>& at_m);

/// "node 12 at (0, 0, 0.047) m, 0.53 mm from the place asked for".
[[nodiscard]] std::string describe(const PressedPlace& place);

/// One sentence if the place is far; else empty.
[[nodiscard]] std::string far_note(const PressedPlace& place);

}  // namespace palpate
