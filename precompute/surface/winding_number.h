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

/// [-] Of the space that the one surface encloses, the share that is outside of the
/// other: both by the winding number's size of a half or more, which also tells inside
/// from outside where a surface has holes (Jacobson, Kavan and Sorkine-Hornung 2013).
/// By 200 points inside, to 0.03; by fewer where less than a hundredth of the bounding
/// box is enclosed; 1 where next to nothing is.
[[nodiscard]] double share_outside(const SurfaceMesh& mesh, const SurfaceMesh& of);

}  // namespace palpate
