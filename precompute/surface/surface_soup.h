// Repairs of a triangle list that need no geometry: it keeps what is there, once.
#pragma once

#include <cstddef>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// How many of each have been taken out of a triangle list.
struct SoupChanges {
  std::size_t welded_vertices = 0;      ///< where an earlier one is, but for rounding
  std::size_t collapsed_triangles = 0;  ///< with a corner twice, after welding
  std::size_t duplicate_triangles = 0;  ///< corners of an earlier one, either way round
  /// That two parts share, listed from either side: neither is kept where other
  /// triangles of these parts close without them.
  std::size_t shared_faces = 0;
  std::size_t isolated_vertices = 0;  ///< of no triangle, after all that
};

/// The surface with equal vertices as one, no triangle twice, and no vertex without a
/// triangle. Vertices are equal to single precision's rounding (weld_points.h, and a
/// hundredth of the mean edge at most). Vertices and triangles that stay keep their
/// order.
[[nodiscard]] SurfaceMesh clean_soup(const SurfaceMesh& mesh, SoupChanges& changes);

/// Index in `original` of the vertex that lies where each vertex of `mesh` does, bit
/// for bit, the first if there are several; -1: none. (n_vertices of mesh)
[[nodiscard]] std::vector<std::int32_t> original_vertices(const SurfaceMesh& mesh,
                                                          const SurfaceMesh& original);

/// The same surface with its vertices in the order of the original ones, then the
/// others in theirs.
[[nodiscard]] SurfaceMesh in_original_order(const SurfaceMesh& mesh,
                                            const SurfaceMesh& original);

}  // namespace palpate
