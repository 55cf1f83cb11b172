// Closed surfaces that are generated rather than read: for the demo, tests and studies.
//
// All are manifold, without self-intersections, and counter-clockwise from outside.
#pragma once

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// Sphere about the origin: an icosahedron cut `levels` times. 10*4^levels + 2
/// vertices, all at radius_m to rounding. @param levels [0, 8].
[[nodiscard]] SurfaceMesh icosphere(double radius_m, int levels);

/// Sphere about a centre, for an inclusion: the coarsest icosphere, of at least one
/// level, whose edges are on average no longer than edge_m, scaled so that its volume
/// is the ball's. @param radius_m, edge_m > 0.
/// @throws InputError if more than 8 levels are needed.
[[nodiscard]] SurfaceMesh sphere_surface(const Eigen::Vector3d& center_m,
                                         double radius_m, double edge_m);

/// Ellipsoid about the origin with the given half axes, from icosphere(1, levels).
[[nodiscard]] SurfaceMesh ellipsoid(const Eigen::Vector3d& half_axes_m, int levels);

/// The demo's body: a smooth organ about 0.14 x 0.09 x 0.045 m, thick at one end and
/// thin at the other, with a flattened underside at z >= 0. @param levels 3: 642
/// vertices; 4: 2562.
[[nodiscard]] SurfaceMesh organ(int levels = 3);

/// Block [-w, w] x [-w, w] x [-depth, 0], w = half_width_m, for contact studies. The
/// top is finest around its middle, which is vertex 0: a square grid of `cells` x
/// `cells` on
/// [-inner, inner]^2 and square rings outside it that grow by about 1 + 2/cells each,
/// so that every triangle is as well shaped as the inner ones.
/// @param cells even, >= 2. @param inner_half_m in (0, half_width_m).
[[nodiscard]] SurfaceMesh graded_block(double half_width_m, double depth_m,
                                       double inner_half_m, int cells);

/// Upright cylinder about the z axis, from z = 0 to height_m, with triangles of about
/// radius_m / rings. @param rings >= 1.
[[nodiscard]] SurfaceMesh cylinder(double radius_m, double height_m, int rings);

}  // namespace palpate
