// Closed surfaces for tests and studies of precompute. All are manifold, without
// self-intersections, and counter-clockwise from outside. Arguments are not checked.
#pragma once

#include <numbers>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

inline constexpr double kDegree = std::numbers::pi / 180.0;  // [rad]

/// Ellipsoid about the origin with the given half axes, from icosphere(1, levels).
[[nodiscard]] SurfaceMesh ellipsoid(const Eigen::Vector3d& half_axes_m, int levels);

/// Block [-w, w] x [-w, w] x [-depth, 0], w = half_width_m, for contact studies. The
/// top is finest around its middle, which is vertex 0. There is a square grid of
/// `cells` x `cells` on [-inner, inner]^2. Square rings outside the grid grow by about
/// 1 + 2/cells each, so that every triangle is as well shaped as the inner ones.
/// @param cells even, >= 2. @param inner_half_m in (0, half_width_m).
[[nodiscard]] SurfaceMesh graded_block(double half_width_m, double depth_m,
                                       double inner_half_m, int cells);

/// Upright cylinder about the z axis, from z = 0 to height_m, with triangles of about
/// radius_m / rings. @param rings >= 1.
[[nodiscard]] SurfaceMesh cylinder(double radius_m, double height_m, int rings);

/// Both in one mesh, whether or not they touch.
[[nodiscard]] SurfaceMesh joined(const SurfaceMesh& a, const SurfaceMesh& b);

}  // namespace palpate
