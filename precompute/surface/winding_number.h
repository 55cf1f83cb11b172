// On which side of a closed surface a point lies.
#pragma once

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// Turns of a surface around a point [-]. 1 inside and 0 outside a closed surface that
/// is counter-clockwise from outside, -1 inside one that is inside out. The value is
/// exact to rounding, wherever the point is, unless the point is on the surface. Sum of
/// the triangles' solid angles over 4 pi (Van Oosterom and Strackee 1983).
[[nodiscard]] double winding_number(const SurfaceMesh& mesh,
                                    const Eigen::Vector3d& point_m);

/// [-] Of the space that the one surface encloses, the share that is outside of the
/// other. A point is inside where the winding number's size is a half or more. This
/// criterion also separates inside from outside where a surface has holes (Jacobson,
/// Kavan and Sorkine-Hornung 2013). The share is counted by 200 points inside, to 0.03.
/// There are fewer points where less than a hundredth of the bounding box is enclosed;
/// the share is 1 where next to nothing is.
[[nodiscard]] double share_outside(const SurfaceMesh& mesh, const SurfaceMesh& of);

}  // namespace palpate
