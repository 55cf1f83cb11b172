// Quadratic tetrahedra with straight edges, and the surface that a tool can press on.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"
#include "precompute/tets/tetrahedralise.h"

namespace palpate {

/// Corners at the ends of the edges, in the order of the nodes in their middles.
inline constexpr std::array<std::array<int, 2>, 6> kTetEdges{
    {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};

using QuadraticTets = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 10, Eigen::RowMajor>;
using QuadraticTriangles =
    Eigen::Matrix<std::int32_t, Eigen::Dynamic, 6, Eigen::RowMajor>;

/// Node order of a tet: corners 0..3, then the middles of edges (0,1) (1,2) (0,2) (0,3)
/// (1,3) (2,3). Node order of a triangle: corners, then the middles of (0,1) (1,2)
/// (2,0).
struct QuadraticMesh {
  Points position_m;           ///< (n_nodes x 3) [m] corners first, then edge middles
  QuadraticTets tet;           ///< (n_tets x 10)
  QuadraticTriangles surface;  ///< (n_triangles x 6) in the order of the surface mesh
  Eigen::Index corners = 0;    ///< number of corner nodes; the surface's vertices first
  std::vector<std::int32_t> region;  ///< (n_tets) of the body; empty: all 0
};

/// Puts a node on the middle of every edge. @param surface the triangles that bound
/// `tets`, over its first vertices. @throws NumericalError if a triangle of the surface
/// is not a face of the tets.
[[nodiscard]] QuadraticMesh make_quadratic(const TetMesh& tets,
                                           const Triangles& surface);

/// (4 x 3) corners of a tet [m].
[[nodiscard]] Eigen::Matrix<double, 4, 3> tet_corners(const QuadraticMesh& mesh,
                                                      Eigen::Index tet);

/// Region that a tet belongs to.
[[nodiscard]] inline std::int32_t region_of(const QuadraticMesh& mesh,
                                            Eigen::Index tet) {
  return mesh.region.empty() ? 0 : mesh.region[static_cast<std::size_t>(tet)];
}

/// The nodes that lie on the surface, ascending.
[[nodiscard]] std::vector<std::int32_t> surface_nodes(const QuadraticMesh& mesh);

}  // namespace palpate
