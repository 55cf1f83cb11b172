#include "formats/report/display_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace palpate {
namespace {

using Cell = std::array<std::int64_t, 3>;

std::vector<std::int32_t> all_of(std::int64_t nodes) {
  std::vector<std::int32_t> node(static_cast<std::size_t>(nodes));
  std::iota(node.begin(), node.end(), 0);
  return node;
}

// Number of each node's cell, in the order in which cells are first seen.
std::vector<std::int32_t> cells_of(const SurfaceMesh& body, double cell_m,
                                   std::int32_t& cells) {
  const Eigen::Vector3d low = body.position_m.colwise().minCoeff().transpose();
  std::map<Cell, std::int32_t> number;
  std::vector<std::int32_t> cell;
  cell.reserve(static_cast<std::size_t>(body.position_m.rows()));
  for (Eigen::Index v = 0; v < body.position_m.rows(); ++v) {
    Cell at{};
    for (Eigen::Index j = 0; j < 3; ++j) {
      at[static_cast<std::size_t>(j)] =
          std::llround(std::floor((body.position_m(v, j) - low[j]) / cell_m));
    }
    cell.push_back(
        number.try_emplace(at, static_cast<std::int32_t>(number.size())).first->second);
  }
  cells = static_cast<std::int32_t>(number.size());
  return cell;
}

// The node of each cell that lies nearest to the mean of its nodes.
std::vector<std::int32_t> nodes_of(const SurfaceMesh& body,
                                   const std::vector<std::int32_t>& cell,
                                   std::int32_t cells) {
  Points sum_m = Points::Zero(cells, 3);
  Eigen::VectorXd count = Eigen::VectorXd::Zero(cells);
  for (std::size_t v = 0; v < cell.size(); ++v) {
    sum_m.row(cell[v]) += body.position_m.row(static_cast<Eigen::Index>(v));
    count[cell[v]] += 1.0;
  }
  std::vector<std::int32_t> node(static_cast<std::size_t>(cells), -1);
  std::vector<double> nearest_m(static_cast<std::size_t>(cells), HUGE_VAL);
  for (std::size_t v = 0; v < cell.size(); ++v) {
    const auto k = static_cast<std::size_t>(cell[v]);
    const double away_m = (body.position_m.row(static_cast<Eigen::Index>(v)) -
                           sum_m.row(cell[v]) / count[cell[v]])
                              .norm();
    if (away_m < nearest_m[k]) {
      nearest_m[k] = away_m;
      node[k] = static_cast<std::int32_t>(v);
    }
  }
  return node;
}

}  // namespace

ThinBody thin_body(const SurfaceMesh& body, std::int64_t most) {
  if (body.position_m.rows() <= most) {
    return {all_of(body.position_m.rows()), body.triangle};
  }
  // A surface meets about as many cells as its area has squares of their size.
  double cell_m =
      bounding_box(body).sizes().maxCoeff() / std::sqrt(static_cast<double>(most));
  std::int32_t cells = 0;
  std::vector<std::int32_t> cell = cells_of(body, cell_m, cells);
  while (cells > most) {
    cell_m *= std::max(
        1.05, std::sqrt(static_cast<double>(cells) / static_cast<double>(most)));
    cell = cells_of(body, cell_m, cells);
  }
  const std::vector<std::int32_t> node = nodes_of(body, cell, cells);
  ThinBody thin{node, {}};
  std::sort(thin.node.begin(), thin.node.end());
  const auto place = [&](std::int32_t vertex) {
    const std::int32_t kept =
        node[static_cast<std::size_t>(cell[static_cast<std::size_t>(vertex)])];
    return static_cast<std::int32_t>(
        std::lower_bound(thin.node.begin(), thin.node.end(), kept) - thin.node.begin());
  };
  std::set<std::array<std::int32_t, 3>> triangles;
  for (Eigen::Index t = 0; t < body.triangle.rows(); ++t) {
    std::array<std::int32_t, 3> corner{place(body.triangle(t, 0)),
                                       place(body.triangle(t, 1)),
                                       place(body.triangle(t, 2))};
    std::rotate(corner.begin(), std::min_element(corner.begin(), corner.end()),
                corner.end());
    if (corner[0] != corner[1] && corner[1] != corner[2] && corner[0] != corner[2]) {
      triangles.insert(corner);
    }
  }
  thin.triangle.resize(std::ssize(triangles), 3);
  Eigen::Index row = 0;
  for (const auto& corner : triangles) {
    thin.triangle.row(row++) << corner[0], corner[1], corner[2];
  }
  return thin;
}

}  // namespace palpate
