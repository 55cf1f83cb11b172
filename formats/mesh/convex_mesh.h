// Whether a triangle mesh bounds a convex body: what a tool must be.
#pragma once

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// [-] Of the size: a mesh whose defect is smaller counts as convex. Coordinates of
/// binary32 make a tenth of it.
inline constexpr double kConvexityTolerance = 1e-6;

/// Largest height [m] of a vertex above the plane of a triangle: 0 to rounding for a
/// closed convex mesh whose triangles look outwards. O(n_vertices n_triangles).
[[nodiscard]] double convexity_defect_m(const SurfaceMesh& mesh);

/// @throws InputError unless the mesh is finite, of at most 20 000 triangles, closed,
/// encloses a volume and is convex to kConvexityTolerance.
void require_convex(const SurfaceMesh& mesh);

}  // namespace palpate
