// Nearest point on a triangle surface: everywhere through a tree of boxes, or nearby by
// walking from triangle to triangle.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// A point of the surface.
struct SurfacePoint {
  std::int32_t triangle = -1;  ///< -1: none
  Eigen::Vector3d area_coordinate =
      Eigen::Vector3d::Zero();  ///< [-] of the triangle's corners; >= 0, sum 1
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< [m]
  double distance_m = 0.0;  ///< [m] >= 0, from the point asked for
};

/// Nearest point of one triangle. @param corner_m (3 x 3) one corner per row [m]; may
/// have no area. `triangle` of the result is -1.
[[nodiscard]] SurfacePoint nearest_in_triangle(const Eigen::Matrix3d& corner_m,
                                               const Eigen::Vector3d& p_m) noexcept;

/// Owns a bounding-volume hierarchy over the triangles of a mesh that must outlive it.
/// Queries are const, do not allocate, and may run in several threads.
class SurfaceSearch {
 public:
  explicit SurfaceSearch(const SurfaceMesh& mesh);

  /// Nearest point of the whole surface; triangle -1 if p_m [m] is not finite or the
  /// mesh is empty. Of equally near triangles, any.
  [[nodiscard]] SurfacePoint nearest(const Eigen::Vector3d& p_m) const noexcept;

  /// Walks from `triangle` to ever nearer triangles among those that share a vertex,
  /// until none is nearer: the local minimum that a contact slides to. It does not jump
  /// to another part of the body when the tool is pressed in deep.
  [[nodiscard]] SurfacePoint walk(const Eigen::Vector3d& p_m,
                                  std::int32_t triangle) const noexcept;

  /// Triangles that share a vertex with `triangle`, itself not among them: the three
  /// (or fewer) across its edges first. Writes at most to.size(), returns how many.
  std::size_t around(std::int32_t triangle, std::span<std::int32_t> to) const noexcept;

  /// (n_triangles x 3) across edge (j, j+1), -1 at a border.
  [[nodiscard]] const Triangles& neighbours() const noexcept { return neighbour_; }

 private:
  // A box over triangles order_[first .. first + count); inner if count is 0: then its
  // children are box_[first] and box_[first + 1].
  struct Box {
    Eigen::AlignedBox3d bounds;
    std::int32_t first = 0;
    std::int32_t count = 0;
  };

  void build(std::int32_t box, std::int32_t begin, std::int32_t end,
             const std::vector<Eigen::AlignedBox3d>& bounds);
  [[nodiscard]] bool has_vertex(std::int32_t triangle,
                                std::int32_t vertex) const noexcept;
  [[nodiscard]] SurfacePoint nearest_in(std::int32_t triangle,
                                        const Eigen::Vector3d& p_m) const noexcept;

  const SurfaceMesh& mesh_;
  Triangles neighbour_;
  std::vector<std::int32_t> order_;            // triangles, leaf by leaf
  std::vector<Box> box_;                       // root first
  std::vector<std::int32_t> vertex_begin_;     // (n_vertices + 1) into vertex_triangle_
  std::vector<std::int32_t> vertex_triangle_;  // triangles around each vertex
};

}  // namespace palpate
