// On which side of a closed surface a point lies.
#pragma once

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// Turns of a surface around a point [-]: 1 inside and 0 outside a closed surface that
/// is counter-clockwise from outside, -1 inside one that is inside out; to rounding,
/// wherever the point is, unless it is on the surface. Sum of the triangles' solid
/// angles over 4 pi (Van Oosterom and Strackee 1983).
[[nodiscard]] double winding_number(const SurfaceMesh& mesh,
                                    const Eigen::Vector3d& point_m);

}  // namespace palpate
