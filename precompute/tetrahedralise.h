// Fills a checked surface with tetrahedra (TetGen), leaving the surface as it is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include <Eigen/Core>

#include "formats/surface_mesh.h"

namespace palpate {

using Tets = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 4, Eigen::RowMajor>;

struct TetMesh {
  Points position_m;  ///< (n x 3) [m] the surface's vertices first, bit for bit
  Tets tet;           ///< (n_tets x 4), positive volume: (b-a) x (c-a) . (d-a) > 0
  Eigen::Index surface_vertices = 0;  ///< how many of the vertices are the surface's
};

struct TetOptions {
  /// [m] (0, inf] tets inside are no larger than a regular one of this edge. Infinite:
  /// they grow away from the surface as far as their shape allows.
  double edge_max_m = std::numeric_limits<double>::infinity();
  double radius_edge_max = 1.414;  ///< [-] [1.2, inf) circumradius over shortest edge
  Eigen::Index tets_max = 4'000'000;  ///< more are refused before they are made
  double time_limit_s = 600.0;        ///< [s] (0, inf)
  std::size_t memory_limit_bytes = 8'000'000'000;
};

/// About how many tets tetrahedralise() will make (within a factor of two).
[[nodiscard]] double estimated_tets(const SurfaceMesh& surface,
                                    const TetOptions& options = {});

/// Tets that fill the closed surface; every triangle of the surface is a face of one of
/// them, new vertices lie inside. Not for surfaces that check_surface() refuses. TetGen
/// runs in a child process, because it can abort, exit or run away; same input, same
/// result. Several disjoint parts are all filled.
/// @throws InputError if the options are out of range or the estimate is above
/// tets_max.
/// @throws NumericalError naming TetGen's reason, or the limit that it reached, or the
///   check of the result that failed (volume, vertices, faces).
[[nodiscard]] TetMesh tetrahedralise(const SurfaceMesh& surface,
                                     const TetOptions& options = {});

struct TetQuality {
  double volume_m3 = 0.0;              ///< sum over the tets
  double smallest_volume_m3 = 0.0;     ///< negative: a tet is inside out
  double smallest_dihedral_rad = 0.0;  ///< over all six edges of all tets
  double largest_dihedral_rad = 0.0;
};

[[nodiscard]] TetQuality tet_quality(const TetMesh& mesh);

}  // namespace palpate
