// Vertices that lie on the edge of a neighbour which does not have them.
#pragma once

#include <cstddef>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// Cuts triangles at vertices that lie on one of their border edges, so that the border
/// there can be joined. A vertex lies on an edge if it is within a millionth of the
/// edge's length from it. The surface stays the same point set to that tolerance. A
/// surface with more than 500 border vertices, which is open, is left alone.
/// @param cuts gains the number of vertices that were put on edges.
[[nodiscard]] SurfaceMesh cut_at_t_junctions(const SurfaceMesh& mesh,
                                             std::size_t& cuts);

}  // namespace palpate
