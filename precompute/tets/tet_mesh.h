// Tetrahedra, and how good they are.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

using Tets = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 4, Eigen::RowMajor>;

struct TetMesh {
  Points position_m;  ///< (n x 3) [m] the surface's vertices first, bit for bit
  Tets tet;           ///< (n_tets x 4), positive volume: (b-a) x (c-a) . (d-a) > 0
  Eigen::Index surface_vertices = 0;  ///< how many of the vertices are the surface's
  /// (n_tets) 0: the body itself; i + 1: inside inner surface i, and not deeper
  std::vector<std::int32_t> region;
};

/// Volume of one tet [m^3]; negative if it is inside out.
[[nodiscard]] double tet_volume_m3(const TetMesh& mesh, Eigen::Index t);

/// [-] Volume over that of the regular tet of its longest edge: 1 at best, 0 for a
/// sliver.
[[nodiscard]] double tet_shape(const TetMesh& mesh, Eigen::Index t);

struct TetQuality {
  double volume_m3 = 0.0;              ///< sum over the tets
  double smallest_volume_m3 = 0.0;     ///< negative: a tet is inside out
  double smallest_dihedral_rad = 0.0;  ///< over all six edges of all tets
  double largest_dihedral_rad = 0.0;
};

[[nodiscard]] TetQuality tet_quality(const TetMesh& mesh);

}  // namespace palpate
