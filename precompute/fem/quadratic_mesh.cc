#include "precompute/fem/quadratic_mesh.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/surface/edge_key.h"

namespace palpate {
QuadraticMesh make_quadratic(const TetMesh& tets, const Triangles& surface) {
  QuadraticMesh mesh;
  mesh.corners = tets.position_m.rows();
  mesh.region = tets.region;
  mesh.tet.resize(tets.tet.rows(), 10);
  std::unordered_map<std::uint64_t, std::int32_t> middle;
  std::vector<std::pair<std::int32_t, std::int32_t>> ends;
  // Nodes 0 to 3 of a tet are its corners, 4 to 9 the middles of kTetEdges. Middles are
  // numbered after all corners, in the order in which edges are met first.
  for (Eigen::Index t = 0; t < tets.tet.rows(); ++t) {
    mesh.tet.row(t).head<4>() = tets.tet.row(t);
    for (int e = 0; e < 6; ++e) {
      const std::int32_t a = tets.tet(t, kTetEdges[static_cast<std::size_t>(e)][0]);
      const std::int32_t b = tets.tet(t, kTetEdges[static_cast<std::size_t>(e)][1]);
      const auto next = static_cast<std::int32_t>(mesh.corners) +
                        static_cast<std::int32_t>(ends.size());
      const auto [at, inserted] = middle.try_emplace(edge_key({a, b}), next);
      if (inserted) {
        ends.emplace_back(a, b);
      }
      mesh.tet(t, 4 + e) = at->second;
    }
  }
  // Edges are straight: a middle is the mean of its ends.
  mesh.position_m.resize(mesh.corners + static_cast<Eigen::Index>(ends.size()), 3);
  mesh.position_m.topRows(mesh.corners) = tets.position_m;
  for (std::size_t e = 0; e < ends.size(); ++e) {
    mesh.position_m.row(mesh.corners + static_cast<Eigen::Index>(e)) =
        0.5 *
        (tets.position_m.row(ends[e].first) + tets.position_m.row(ends[e].second));
  }
  // Nodes 3 to 5 of a face are the middles of (0, 1), (1, 2), (2, 0).
  mesh.surface.resize(surface.rows(), 6);
  for (Eigen::Index t = 0; t < surface.rows(); ++t) {
    for (int j = 0; j < 3; ++j) {
      mesh.surface(t, j) = surface(t, j);
      const auto at = middle.find(edge_key({surface(t, j), surface(t, (j + 1) % 3)}));
      if (at == middle.end()) {
        throw NumericalError(
            fmt::format("surface triangle {} is not a face of the tetrahedra", t));
      }
      mesh.surface(t, 3 + j) = at->second;
    }
  }
  return mesh;
}

Eigen::Matrix<double, 4, 3> tet_corners(const QuadraticMesh& mesh, Eigen::Index tet) {
  Eigen::Matrix<double, 4, 3> corner;
  for (int j = 0; j < 4; ++j) {
    corner.row(j) = mesh.position_m.row(mesh.tet(tet, j));
  }
  return corner;
}

std::vector<std::int32_t> surface_nodes(const QuadraticMesh& mesh) {
  std::vector<std::int32_t> nodes(mesh.surface.data(),
                                  mesh.surface.data() + mesh.surface.size());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

}  // namespace palpate
