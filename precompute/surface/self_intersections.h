// Pairs of triangles that cut through each other.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// Pairs (a < b) of triangles that share a point which is not a common corner or on a
/// common edge; ascending. Decided exactly (CGAL's predicates). Triangles whose corners
/// lie exactly on one line are passed over: they are a defect of their own.
[[nodiscard]] std::vector<std::pair<std::int32_t, std::int32_t>> self_intersections(
    const SurfaceMesh& mesh);

}  // namespace palpate
