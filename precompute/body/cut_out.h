// Parts of a body around some of its vertices, cut out of its tetrahedra: what they
// take does not grow with the body.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/mesh/surface_mesh.h"
#include "precompute/tets/tet_mesh.h"

namespace palpate {

/// Tets that know which others they meet.
struct ConnectedTets {
  TetMesh mesh;
  Tets across;  ///< (n_tets x 4) tet across the face opposite to corner j, or -1
  std::vector<std::int32_t> tet_of;  ///< (n_corners) one of each corner's tets
};

[[nodiscard]] ConnectedTets connect(TetMesh mesh);

struct CutOut {
  TetMesh tets;       ///< in the body's order, as are their corners
  Triangles surface;  ///< faces that are the body's outer surface, outside out
  Triangles cut;      ///< faces to the rest of the body, outside out
  std::vector<std::int32_t> corner;  ///< (n_corners) of the body, ascending
};

/// All tets with a corner no farther than `radius_m` from one of the vertices, as far
/// as such corners are connected. What comes near around a fold is not taken. Corners
/// on the cut are farther away than the radius. Time and memory grow with the result
/// alone.
/// @param vertices corners of the body.
[[nodiscard]] CutOut cut_out(const ConnectedTets& body,
                             std::span<const std::int32_t> vertices, double radius_m);

}  // namespace palpate
