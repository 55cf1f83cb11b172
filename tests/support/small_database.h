// A small body with made-up responses, for tests of what reads databases.
#pragma once

#include "formats/database/response_database.h"

namespace palpate {

/// A unit octahedron of `radius_m`: 6 nodes, 8 triangles, normals outward.
[[nodiscard]] SurfaceMesh octahedron(double radius_m);

/// The octahedron under two tools, "ball" and "tip". Hertz-like curves differ from node
/// to node, with one falling curve (node 4) and one node without a response (node 5).
[[nodiscard]] ResponseDatabase small_database();

/// Two terms for all nodes: 0.26 and 0.3 of the force, in 0.42 and 4.5 s.
[[nodiscard]] ResponseRelaxation relaxing();

/// How the octahedron's responses relax as it is rendered: two times, shares that rise
/// from node to node, three sites.
[[nodiscard]] Viscoelasticity viscous();

/// Two runs of which the first was held.
[[nodiscard]] Measurement held();

}  // namespace palpate
