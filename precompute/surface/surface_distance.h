// How far one surface is from another.
#pragma once

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// The largest distance [m] of a vertex or the middle of a triangle of `from` to the
/// surface `to`; 0 if `from` has no triangles. Isolated vertices do not count. A
/// triangle of `to` without area counts as its edges.
/// @param to at least one triangle.
[[nodiscard]] double distance_to_surface_m(const SurfaceMesh& from,
                                           const SurfaceMesh& to);

}  // namespace palpate
