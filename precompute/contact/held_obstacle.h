// Where a tool on its path meets a part of the surface that does not move.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"
#include "precompute/contact/linear_indentation.h"

namespace palpate {

/// A place on the surface that is held, and the normal of a face at it: at an edge or
/// corner there is one for each face, held or free.
struct HeldPoint {
  Eigen::Vector3d position_m;
  Eigen::Vector3d normal;  ///< [-] outward, unit
};

/// The held vertices, and seven points of every edge whose ends are held.
[[nodiscard]] std::vector<HeldPoint> held_points(
    const SurfaceMesh& surface,
    const std::function<bool(const Eigen::Vector3d& p_m)>& is_held);

/// Penetration at which the path must end: no force makes way for the tool where it
/// meets a held point that faces it (tool's normal . point's normal < 0). An overlap of
/// a fiftieth of the largest depth is let pass, and a tenth of that depth is always
/// left: closer to a support than that, responses are those of a body whose hold gives.
/// @return depth_max_m of the path where nothing is in the way [m].
[[nodiscard]] double depth_until_held_m(std::span<const HeldPoint> held,
                                        const IndentationPath& path);

}  // namespace palpate
