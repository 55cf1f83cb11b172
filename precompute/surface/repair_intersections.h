// Takes out triangles that cut through each other, and fills in what they leave.
#pragma once

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// Cuts out the triangles of each crossing, with rings of neighbours where that is not
/// enough. Fills the holes between the vertices at the rim: no vertex is new. Parts of
/// a component that a cut leaves go, but for the largest. The result is a closed
/// manifold of as many components, with the fewest crossings that were reached. With as
/// many crossings as before, the result is the surface as it was.
/// @param mesh a closed manifold.
[[nodiscard]] SurfaceMesh repair_intersections(const SurfaceMesh& mesh);

}  // namespace palpate
