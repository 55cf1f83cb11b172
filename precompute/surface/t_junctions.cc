#include "precompute/surface/t_junctions.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "formats/base/at.h"

namespace palpate {
namespace {

constexpr double kOnBorder = 1e-6;           // [-] of the edge's length
constexpr std::ptrdiff_t kMostBorder = 500;  // vertices; an open surface has more

// [-] of the way from a to b that the vertex lies at, if it lies on that edge.
std::optional<double> share_on(const SurfaceMesh& mesh, std::int32_t a, std::int32_t b,
                               std::int32_t v) {
  const Eigen::RowVector3d ab = mesh.position_m.row(b) - mesh.position_m.row(a);
  const Eigen::RowVector3d av = mesh.position_m.row(v) - mesh.position_m.row(a);
  const double length2 = ab.squaredNorm();
  const double share = length2 > 0.0 ? av.dot(ab) / length2 : 0.0;
  const bool on = share > kOnBorder && share < 1.0 - kOnBorder &&
                  (av - share * ab).squaredNorm() <= kOnBorder * kOnBorder * length2;
  return on ? std::optional(share) : std::nullopt;
}

// One cut: the triangle's border edge (j, j + 1) at the first of the vertices on it.
struct BorderCut {
  Eigen::Index triangle = 0;
  int j = 0;
  std::int32_t vertex = -1;
};

std::optional<BorderCut> next_cut(const SurfaceMesh& mesh) {
  const Triangles neighbour = triangle_neighbours(mesh.triangle);
  // Vertices of edges that have one triangle only. All pairs of them and border edges
  // are tried, so that a mesh with a long border is left alone.
  std::vector<std::int32_t> border;
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    for (int j = 0; j < 3; ++j) {
      if (neighbour(t, j) < 0) {
        border.push_back(mesh.triangle(t, j));
        border.push_back(mesh.triangle(t, (j + 1) % 3));
      }
    }
  }
  std::sort(border.begin(), border.end());
  border.erase(std::unique(border.begin(), border.end()), border.end());
  if (std::ssize(border) > kMostBorder) {
    return std::nullopt;
  }
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    for (int j = 0; j < 3; ++j) {
      if (neighbour(t, j) >= 0) {
        continue;
      }
      for (const std::int32_t v : border) {
        if (v != mesh.triangle(t, (j + 2) % 3) &&
            share_on(mesh, mesh.triangle(t, j), mesh.triangle(t, (j + 1) % 3), v)) {
          return BorderCut{t, j, v};
        }
      }
    }
  }
  return std::nullopt;
}

}  // namespace

SurfaceMesh cut_at_t_junctions(const SurfaceMesh& mesh, std::size_t& cuts) {
  SurfaceMesh result = mesh;
  for (std::ptrdiff_t i = 0; i < kMostBorder; ++i) {
    const std::optional<BorderCut> cut = next_cut(result);
    if (!cut) {
      break;
    }
    // The triangle becomes two: each takes one half of the cut edge.
    const Eigen::Index added = result.triangle.rows();
    result.triangle.conservativeResize(added + 1, 3);
    result.triangle.row(added) = result.triangle.row(cut->triangle);
    result.triangle(cut->triangle, (cut->j + 1) % 3) = cut->vertex;
    result.triangle(added, cut->j) = cut->vertex;
    ++cuts;
  }
  return result;
}

}  // namespace palpate
