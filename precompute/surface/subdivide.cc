#include "precompute/surface/subdivide.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace palpate {

SurfaceMesh subdivide_midpoint(const SurfaceMesh& mesh) {
  const Eigen::Index n = mesh.position_m.rows();
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middle;
  SurfaceMesh fine;
  fine.triangle.resize(4 * mesh.triangle.rows(), 3);
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    std::array<std::int32_t, 3> corner{};
    std::array<std::int32_t, 3> half{};  // middle of edge (j, j+1)
    for (int j = 0; j < 3; ++j) {
      const auto edge = std::minmax(mesh.triangle(t, j), mesh.triangle(t, (j + 1) % 3));
      const auto next = static_cast<std::int32_t>(n + std::ssize(middle));
      corner[static_cast<std::size_t>(j)] = mesh.triangle(t, j);
      half[static_cast<std::size_t>(j)] = middle.try_emplace(edge, next).first->second;
    }
    fine.triangle.row(4 * t) << corner[0], half[0], half[2];
    fine.triangle.row(4 * t + 1) << corner[1], half[1], half[0];
    fine.triangle.row(4 * t + 2) << corner[2], half[2], half[1];
    fine.triangle.row(4 * t + 3) << half[0], half[1], half[2];
  }
  fine.position_m.resize(n + std::ssize(middle), 3);
  fine.position_m.topRows(n) = mesh.position_m;
  for (const auto& [edge, vertex] : middle) {
    fine.position_m.row(vertex) =
        0.5 * (mesh.position_m.row(edge.first) + mesh.position_m.row(edge.second));
  }
  return fine;
}

}  // namespace palpate
