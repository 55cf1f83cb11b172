// Fills a checked surface with tetrahedra (TetGen), leaving the surface as it is.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"
#include "precompute/tets/inner_surface.h"
#include "precompute/tets/tet_mesh.h"

namespace palpate {

/// Wanted edge [m] at a point of the body. It runs in another process and knows its
/// parameters alone.
using EdgeWish = double (*)(const Eigen::Vector3d& p_m,
                            const std::array<double, 5>& parameter);

struct TetOptions {
  /// [m] (0, inf] tets inside are no larger than a regular one of this edge. Infinite:
  /// they grow away from the surface as far as their shape allows.
  double edge_max_m = std::numeric_limits<double>::infinity();
  double radius_edge_max = 1.414;  ///< [-] [1.2, inf) circumradius over shortest edge
  Eigen::Index tets_max = 4'000'000;  ///< more are refused before they are made
  double time_limit_s = 600.0;        ///< [s] (0, inf)
  std::size_t memory_limit_bytes = 8'000'000'000;
  /// On top of edge_max_m: a tet is no larger than the regular one of the edge wanted
  /// at its centre. Exceptions are tets that a coarse surface triangle holds up and, by
  /// a little, tets swapped against slivers. nullptr: no wish.
  EdgeWish size = nullptr;
  std::array<double, 5> size_parameter{};
};

/// About how many tets tetrahedralise() will make (within a factor of two), without
/// inner surfaces or wanted sizes.
[[nodiscard]] double estimated_tets(const SurfaceMesh& surface,
                                    const TetOptions& options = {});

/// Tets that fill the closed surface; every triangle of the surface is a face of one of
/// them. Not for surfaces that check_surface() refuses. TetGen runs in a child process,
/// because it can abort, exit or run away; same input, same result. Several disjoint
/// parts are all filled.
///
/// If TetGen dies or gives up, or its result does not pass the checks, TetGen is
/// tried again. The retries go without improving tets, with vertices moved by 1e-9 and
/// 1e-7 of the extent while tets are made, and without grading. Moved vertices are put
/// back: bit for bit as before. The first result that passes is taken; in a failure the
/// first reason is named.
///
/// Inner surfaces part the tets into regions, see TetMesh::region. Each of their
/// triangles is a face between two tets, or on the boundary if the surface is a cavity.
/// A cavity holds no tets but those of the outer surface's parts in it. Vertices: those
/// of the surface, those of inner[0], inner[1] and so on, all bit for bit, then new
/// ones that lie off the surfaces.
/// @throws InputError if the options are out of range, the estimate is above tets_max,
///   or an inner surface is refused (see check_inner_surfaces()).
/// @throws NumericalError naming TetGen's reason, or the limit that it reached, or the
///   check of the result that failed. The checks are those of a region's volume to
///   1e-6, vertices and faces. The error also names the surface's poorest triangle and
///   what can be done about it.
[[nodiscard]] TetMesh tetrahedralise(const SurfaceMesh& surface,
                                     const TetOptions& options = {},
                                     std::span<const InnerSurface> inner = {});

}  // namespace palpate
