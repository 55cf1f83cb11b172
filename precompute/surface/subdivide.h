// A finer triangulation of the same surface.
#pragma once

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// Cuts each triangle into four at the middles of its edges. The original vertices come
/// first and unchanged; triangle t becomes the triangles 4t to 4t+3 (three corners,
/// then the middle one). The geometry is the same: area, volume and normals do not
/// change.
[[nodiscard]] SurfaceMesh subdivide_midpoint(const SurfaceMesh& mesh);

}  // namespace palpate
