// What is poor, though not refused, about a surface and its tets.
#pragma once

#include <string>
#include <vector>

#include "precompute/surface/surface_check.h"
#include "precompute/tets/tet_mesh.h"

namespace palpate {

/// A line if a triangle has an angle below 5 degrees. The tets at it will be poor too,
/// for the mesher leaves the surface as it is. A line if the surface has more than
/// 150,000 triangles, with the edge that makes 30,000. Empty for a refused surface.
[[nodiscard]] std::vector<std::string> quality_notes(const SurfaceReport& report);

/// A line if a tet has a dihedral angle below 1 degree.
[[nodiscard]] std::vector<std::string> quality_notes(const TetQuality& quality);

}  // namespace palpate
