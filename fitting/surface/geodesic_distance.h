// Distance along a surface from the nearest of some points on it.
#pragma once

#include <span>

#include <Eigen/Core>

#include "fitting/surface/attached_point.h"

namespace palpate {

/// (n) [m] at every vertex, by fast marching over triangles (Kimmel and Sethian 1998;
/// along edges where a triangle is obtuse). Distances are of first order, a few per
/// cent too long. Infinite where no source can be reached.
[[nodiscard]] Eigen::VectorXd geodesic_distance_m(
    const SurfaceMesh& mesh, std::span<const AttachedPoint> source);

}  // namespace palpate
