// A surface with fewer triangles where a computation does not look closely.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "formats/mesh/surface_mesh.h"
#include "precompute/surface/refine_surface.h"

namespace palpate {

struct CoarsenedSurface {
  SurfaceMesh surface;
  std::vector<std::int32_t> vertex;  ///< (kept) where the kept vertices are now
};

/// Collapses edges, keeping volume and shape (Lindstrom and Turk 1998). No new edge
/// becomes longer than wanted at its new end, and no triangle turns by more than 25
/// degrees. The result is closed and manifold as before. The result may cross itself
/// where the body is thinner than the edges.
/// @param surface closed, manifold. @param kept vertices that stay in their places.
/// @param part which part of the surface a point belongs to. Edges between different
/// parts stay, and a new point stays in the part of both old ones.
[[nodiscard]] CoarsenedSurface coarsen_surface(
    const SurfaceMesh& surface, const EdgeLength& wanted,
    std::span<const std::int32_t> kept,
    const std::function<int(const Eigen::Vector3d&)>& part);

}  // namespace palpate
