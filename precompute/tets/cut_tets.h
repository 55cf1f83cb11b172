// Tets cut where a yes becomes a no.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "formats/mesh/surface_mesh.h"
#include "precompute/tets/cut_regions.h"
#include "precompute/tets/tet_mesh.h"

namespace palpate {

/// Tets and the triangles that bound them, cut along one wall after another. Tets stay
/// positive, triangles stay faces, and neighbours stay conforming. For this a piece,
/// and each of its faces, is made of tets or triangles about its vertex of the lowest
/// number.
class CutTets {
 public:
  using In = std::function<bool(const Eigen::Vector3d& p_m)>;

  /// @param surface over the first vertices of the tets. @param fixed vertices from the
  /// first on that are never moved.
  CutTets(TetMesh tets, Triangles surface, Eigen::Index fixed);

  /// Every tet that is in the part and whose region may be taken gets `region`. An edge
  /// whose ends differ is cut once, where halving finds the change.
  void along(const In& in_part, std::int32_t region,
             const std::function<bool(std::int32_t)>& may_take);

  /// Vertices of the surface first: old ones as they were, then new ones.
  [[nodiscard]] FilledBody take();

 private:
  struct Crossing {
    std::int32_t a = 0;  // a < b
    std::int32_t b = 0;
    double share = 0.0;        // [-] of the way from a to b
    std::int32_t vertex = -1;  // that was made there
  };
  using Loop = std::vector<std::int32_t>;  // vertices around a convex polygon

  [[nodiscard]] Eigen::Vector3d vertex_m(std::int32_t v) const;
  void find_crossings(const In& in_part);
  void move_onto_wall();
  [[nodiscard]] bool may_move(std::int32_t v, const Eigen::Vector3d& to_m) const;
  void add_vertices();
  [[nodiscard]] std::int32_t cut_between(std::int32_t a, std::int32_t b) const;
  [[nodiscard]] Loop part_of(std::int32_t a, std::int32_t b, std::int32_t c,
                             int side) const;
  [[nodiscard]] Loop wall_in(const std::int32_t* corner) const;
  [[nodiscard]] std::vector<std::array<std::int32_t, 4>> piece_of(
      const std::int32_t* corner, int side) const;
  void cut_tets(const In& in_part, std::int32_t region,
                const std::function<bool(std::int32_t)>& may_take);
  void cut_surface();

  TetMesh mesh_;
  Triangles surface_;
  std::vector<bool> fixed_;
  std::vector<int> side_;           // of each vertex: 1 in, -1 out, 0 on the wall
  std::vector<Crossing> crossing_;  // by a, then b
  std::vector<std::vector<std::int32_t>> around_;  // tets of each vertex
};

}  // namespace palpate
