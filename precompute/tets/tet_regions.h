// Which tets lie inside which inner surface, from the faces that they share.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"
#include "precompute/tets/tet_mesh.h"

namespace palpate {

struct TetRegions {
  /// (n_tets) 0 where no surface is around the tet; i + 1: the innermost is surface i
  std::vector<std::int32_t> region;
  /// (all triangles of inner[0], inner[1], ...) region of the tet outside of each
  std::vector<std::int32_t> around;
};

/// No point is located. A tet that lies behind a triangle of surface i is inside the
/// surface. So is every tet that is reached from there without passing through a
/// surface.
/// @param tet positive tets.
/// @param inner (n_triangles x 3) each, vertex indices of the tets, counter-clockwise
/// from outside, surfaces disjoint.
/// @throws NumericalError if a triangle is not a face of two tets, or if a region would
/// be inside two surfaces at once.
[[nodiscard]] TetRegions tet_regions(const Tets& tet, std::span<const Triangles> inner);

/// Faces of one tet only: the boundary. (n x 3) corners ascending, rows ascending.
[[nodiscard]] Triangles boundary_faces(const Tets& tet);

/// The triangles with corners ascending, rows ascending, to compare with the above.
[[nodiscard]] Triangles sorted_faces(const Triangles& triangle);

/// Takes away the tets of the regions that are `hollow` (n_regions). Also takes away
/// the vertices from `kept_vertices` on that belong to no tet any more. Other tets and
/// vertices keep their order.
void remove_regions(std::span<const bool> hollow, Eigen::Index kept_vertices,
                    TetMesh& mesh);

}  // namespace palpate
