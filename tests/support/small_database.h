// A small body with made-up responses, for tests of what reads databases.
#pragma once

#include "formats/response_database.h"

namespace palpate {

/// A unit octahedron of `radius_m`: 6 nodes, 8 triangles, normals outward.
[[nodiscard]] SurfaceMesh octahedron(double radius_m);

/// The octahedron under two tools, "ball" and "tip": Hertz-like curves that differ from
/// node to node, one falling curve (node 4), one node without a response (node 5).
[[nodiscard]] ResponseDatabase small_database();

}  // namespace palpate
