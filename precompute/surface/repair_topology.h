// Makes a triangle list a closed manifold without moving a vertex.
#pragma once

#include <cstddef>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

struct TopologyChanges {
  std::size_t turned_triangles = 0;  ///< that faced against their neighbours
  std::size_t split_vertices = 0;    ///< where separate sheets touched: one for each
  std::size_t stitched_borders = 0;  ///< pairs of border edges at one place, joined
  std::size_t degenerate_triangles = 0;  ///< without area, taken out
  std::size_t filled_holes = 0;          ///< with triangles between vertices of the rim
};

/// Turns, splits, stitches, takes out and fills until the triangles are a manifold, in
/// that order. Vertices keep their places; only filling adds area.
/// @param hole_max_m [m] the diagonal of the largest hole to fill.
[[nodiscard]] SurfaceMesh repair_topology(const SurfaceMesh& mesh, double hole_max_m,
                                          TopologyChanges& changes);

/// For a wrap: turns, stitches and fills every hole, however large. What cannot be
/// filled stays open; the result may cross itself.
[[nodiscard]] SurfaceMesh close_holes(const SurfaceMesh& mesh,
                                      TopologyChanges& changes);

}  // namespace palpate
