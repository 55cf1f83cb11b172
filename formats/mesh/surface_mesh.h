// A closed or open triangle surface in metres, and the geometry that everything reads
// off it.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace palpate {

using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Triangles = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 3, Eigen::RowMajor>;

struct SurfaceMesh {
  Points position_m;  ///< (n_vertices x 3) [m]
  Triangles
      triangle;  ///< (n_triangles x 3) vertex indices, counter-clockwise from outside
};

/// Outward unit normals at the vertices. Each triangle's normal is weighted by the
/// angle of its corner (Thurmer and Wuthrich 1998). So the vertex normals do not depend
/// on the triangulation. (n_vertices x 3); zero where a vertex has no triangle of
/// positive area.
[[nodiscard]] Points vertex_normals(const SurfaceMesh& mesh);

/// Volume that a closed surface encloses [m^3]; negative if it is inside out.
[[nodiscard]] double enclosed_volume_m3(const SurfaceMesh& mesh);

[[nodiscard]] double surface_area_m2(const SurfaceMesh& mesh);

/// Bounding box of the vertices [m]; empty for no vertices.
[[nodiscard]] Eigen::AlignedBox3d bounding_box(const SurfaceMesh& mesh);

/// Mean edge length [m].
[[nodiscard]] double mean_edge_m(const SurfaceMesh& mesh);

/// Neighbour across edge (j, j+1) of each triangle, -1 at a border.
/// (n_triangles x 3). Of an edge with more than two triangles, two are paired.
[[nodiscard]] Triangles triangle_neighbours(const Triangles& triangle);

/// Vertices joined to each vertex by an edge, ascending.
[[nodiscard]] std::vector<std::vector<std::int32_t>> vertex_neighbours(
    Eigen::Index vertices, const Triangles& triangle);

}  // namespace palpate
