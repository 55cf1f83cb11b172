// Where a tool on its path meets a part of the surface that does not move.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"
#include "precompute/contact/linear_indentation.h"

namespace palpate {

/// A held place on the surface, with the normal of a face at the place. An edge or
/// corner has one such point for each of its faces, held or free.
struct HeldPoint {
  Eigen::Vector3d position_m;
  Eigen::Vector3d normal;  ///< [-] outward, unit
};

/// The held vertices, and seven points of every edge whose ends are held.
[[nodiscard]] std::vector<HeldPoint> held_points(
    const SurfaceMesh& surface,
    const std::function<bool(const Eigen::Vector3d& p_m)>& is_held);

/// Penetration at which the path must end: no force displaces a held point. A held
/// point counts if it faces the tool (tool's normal . point's normal < 0). An overlap
/// of a fiftieth of the largest depth is permitted, and a tenth of the largest depth is
/// always left. Closer to a support, responses are those of a body whose hold deforms.
/// @return depth_max_m of the path where nothing is in the way [m].
[[nodiscard]] double depth_until_held_m(std::span<const HeldPoint> held,
                                        const IndentationPath& path);

}  // namespace palpate
