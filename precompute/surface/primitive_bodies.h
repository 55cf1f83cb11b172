// Closed surfaces that are generated rather than read: for inclusions and the demo.
//
// All are manifold, without self-intersections, and counter-clockwise from outside.
#pragma once

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// Sphere about the origin: an icosahedron cut `levels` times. 10*4^levels + 2
/// vertices, all at radius_m to rounding. @param levels [0, 8].
[[nodiscard]] SurfaceMesh icosphere(double radius_m, int levels);

/// Sphere about a centre, for an inclusion. The sphere is the coarsest icosphere, of at
/// least one level, whose edges are on average no longer than edge_m. It is scaled so
/// that its volume is the ball's.
/// @param radius_m, edge_m > 0.
/// @throws InputError if more than 8 levels are needed.
[[nodiscard]] SurfaceMesh sphere_surface(const Eigen::Vector3d& center_m,
                                         double radius_m, double edge_m);

/// The demo's body: a smooth organ about 0.14 x 0.09 x 0.045 m. It is thick at one end
/// and thin at the other, with a flattened underside at z >= 0.
/// @param levels 3: 642 vertices; 4: 2562.
[[nodiscard]] SurfaceMesh organ(int levels = 3);

}  // namespace palpate
