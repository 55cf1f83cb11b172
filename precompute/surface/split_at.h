// The same surface with one vertex more.
#pragma once

#include "formats/mesh/surface_mesh.h"
#include "formats/mesh/surface_search.h"

namespace palpate {

/// Makes a vertex of a place inside a triangle or on one of its edges: the last one.
/// The geometry is the same, and so are the vertices before it.
/// @param place triangle and area coordinates, of which two at least are positive.
[[nodiscard]] SurfaceMesh split_at(const SurfaceMesh& mesh, const SurfacePoint& place);

}  // namespace palpate
