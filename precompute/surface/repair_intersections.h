// Takes out triangles that cut through each other, and fills in what they leave.
#pragma once

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// One pass: the triangles around each crossing are replaced by others between the
/// vertices at the rim, or, where that fails, by a smooth patch with new vertices. The
/// result may still cross itself. Only for a closed manifold.
[[nodiscard]] SurfaceMesh repair_intersections(const SurfaceMesh& mesh);

}  // namespace palpate
