#include "precompute/surface/surface_soup.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>
#include <vector>

#include "formats/mesh/weld_points.h"

namespace palpate {
namespace {

using Place = std::array<double, 3>;
using Corners = std::array<std::int32_t, 3>;

Place place(const SurfaceMesh& mesh, Eigen::Index v) {
  return {mesh.position_m(v, 0), mesh.position_m(v, 1), mesh.position_m(v, 2)};
}

// The mesh's vertices in the order of `old_of`, with triangles to match.
SurfaceMesh renumbered(const SurfaceMesh& mesh, const std::vector<std::int32_t>& old_of,
                       const std::vector<Corners>& triangle) {
  std::vector<std::int32_t> new_of(static_cast<std::size_t>(mesh.position_m.rows()),
                                   -1);
  SurfaceMesh result;
  result.position_m.resize(std::ssize(old_of), 3);
  for (std::size_t v = 0; v < old_of.size(); ++v) {
    result.position_m.row(static_cast<Eigen::Index>(v)) =
        mesh.position_m.row(old_of[v]);
    new_of[static_cast<std::size_t>(old_of[v])] = static_cast<std::int32_t>(v);
  }
  result.triangle.resize(std::ssize(triangle), 3);
  for (std::size_t t = 0; t < triangle.size(); ++t) {
    for (std::size_t j = 0; j < 3; ++j) {
      result.triangle(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(j)) =
          new_of[static_cast<std::size_t>(triangle[t][j])];
    }
  }
  return result;
}

// The first vertex at the place of each, but for rounding.
std::vector<std::int32_t> first_at_place(const SurfaceMesh& mesh) {
  std::vector<Eigen::Vector3d> points;
  for (Eigen::Index v = 0; v < mesh.position_m.rows(); ++v) {
    points.emplace_back(mesh.position_m.row(v).transpose());
  }
  const double tolerance_m = std::min(rounding_of(points), 0.01 * mean_edge_m(mesh));
  std::vector<std::int32_t> first;
  for (const std::size_t v : first_within(points, tolerance_m)) {
    first.push_back(static_cast<std::int32_t>(v));
  }
  return first;
}

}  // namespace

SurfaceMesh clean_soup(const SurfaceMesh& mesh, SoupChanges& changes) {
  const std::vector<std::int32_t> first = first_at_place(mesh);
  std::vector<bool> used(first.size(), false);
  std::vector<Corners> kept;
  std::set<Corners> seen;
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    Corners corner{};
    for (std::size_t j = 0; j < 3; ++j) {
      corner[j] = first[static_cast<std::size_t>(
          mesh.triangle(t, static_cast<Eigen::Index>(j)))];
    }
    Corners sorted = corner;
    std::sort(sorted.begin(), sorted.end());
    if (sorted[0] == sorted[1] || sorted[1] == sorted[2]) {
      ++changes.collapsed_triangles;
    } else if (!seen.insert(sorted).second) {
      ++changes.duplicate_triangles;
    } else {
      kept.push_back(corner);
      for (const std::int32_t v : corner) {
        used[static_cast<std::size_t>(v)] = true;
      }
    }
  }
  std::vector<std::int32_t> old_of;
  for (std::size_t v = 0; v < first.size(); ++v) {
    if (used[v]) {
      old_of.push_back(static_cast<std::int32_t>(v));
    } else {
      const bool welded = first[v] != static_cast<std::int32_t>(v);
      ++(welded ? changes.welded_vertices : changes.isolated_vertices);
    }
  }
  return renumbered(mesh, old_of, kept);
}

std::vector<std::int32_t> original_vertices(const SurfaceMesh& mesh,
                                            const SurfaceMesh& original) {
  std::map<Place, std::int32_t> at;
  for (std::int32_t v = 0; v < original.position_m.rows(); ++v) {
    at.try_emplace(place(original, v), v);
  }
  std::vector<std::int32_t> index;
  for (Eigen::Index v = 0; v < mesh.position_m.rows(); ++v) {
    const auto found = at.find(place(mesh, v));
    index.push_back(found == at.end() ? -1 : found->second);
  }
  return index;
}

SurfaceMesh in_original_order(const SurfaceMesh& mesh, const SurfaceMesh& original) {
  const std::vector<std::int32_t> index = original_vertices(mesh, original);
  std::vector<std::int32_t> old_of(index.size());
  std::iota(old_of.begin(), old_of.end(), 0);
  std::stable_sort(old_of.begin(), old_of.end(), [&](std::int32_t a, std::int32_t b) {
    const auto key = [&](std::int32_t v) {
      return static_cast<std::uint32_t>(index[static_cast<std::size_t>(v)]);  // -1 last
    };
    return key(a) < key(b);
  });
  std::vector<Corners> triangle;
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    triangle.push_back({mesh.triangle(t, 0), mesh.triangle(t, 1), mesh.triangle(t, 2)});
  }
  return renumbered(mesh, old_of, triangle);
}

}  // namespace palpate
