#include "precompute/surface/surface_soup.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>
#include <vector>

#include "formats/base/at.h"
#include "formats/mesh/weld_points.h"
#include "precompute/surface/disjoint_sets.h"
#include "precompute/surface/edge_key.h"

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

// Whether the corners run as they do when ascending.
bool runs_up(const Corners& corner) {
  const auto least = std::min_element(corner.begin(), corner.end()) - corner.begin();
  return corner[at((least + 1) % 3)] < corner[at((least + 2) % 3)];
}

// Takes out triangles that are there from both sides, where their part has others and
// what is left runs through each edge as often upwards as downwards.
void drop_shared_faces(std::size_t vertices, const std::vector<bool>& twice,
                       std::vector<Corners>& triangle, SoupChanges& changes) {
  Partition part(vertices);
  for (const Corners& corner : triangle) {
    part.join(corner[0], corner[1]);
    part.join(corner[0], corner[2]);
  }
  std::set<std::int32_t> has_others;
  for (std::size_t t = 0; t < triangle.size(); ++t) {
    if (!twice[t]) {
      has_others.insert(part.find(triangle[t][0]));
    }
  }
  std::vector<Corners> left;
  std::map<std::uint64_t, int> sum;  // by edge: upwards less downwards
  for (std::size_t t = 0; t < triangle.size(); ++t) {
    if (twice[t] && has_others.contains(part.find(triangle[t][0]))) {
      continue;
    }
    left.push_back(triangle[t]);
    for (std::size_t j = 0; j < 3 && !twice[t]; ++j) {
      const std::int32_t from = triangle[t][j];
      const std::int32_t to = triangle[t][(j + 1) % 3];
      sum[edge_key({from, to})] += from < to ? 1 : -1;
    }
  }
  if (std::all_of(sum.begin(), sum.end(), [](const auto& edge) {
        return edge.second == 0;
      })) {
    changes.shared_faces = triangle.size() - left.size();
    changes.duplicate_triangles -= changes.shared_faces;
    triangle = std::move(left);
  }
}

}  // namespace

SurfaceMesh clean_soup(const SurfaceMesh& mesh, SoupChanges& changes) {
  const std::vector<std::int32_t> first = first_at_place(mesh);
  std::vector<Corners> kept;
  std::vector<bool> twice;  // also from the other side
  std::map<Corners, std::size_t> seen;
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    Corners corner{};
    for (std::size_t j = 0; j < 3; ++j) {
      corner[j] = first[at(mesh.triangle(t, static_cast<Eigen::Index>(j)))];
    }
    Corners sorted = corner;
    std::sort(sorted.begin(), sorted.end());
    if (sorted[0] == sorted[1] || sorted[1] == sorted[2]) {
      ++changes.collapsed_triangles;
      continue;
    }
    const auto [place, is_new] = seen.try_emplace(sorted, kept.size());
    if (is_new) {
      kept.push_back(corner);
      twice.push_back(false);
    } else {
      ++changes.duplicate_triangles;
      twice[place->second] =
          twice[place->second] || runs_up(kept[place->second]) != runs_up(corner);
    }
  }
  if (std::find(twice.begin(), twice.end(), true) != twice.end()) {
    drop_shared_faces(first.size(), twice, kept, changes);
  }
  std::vector<bool> used(first.size(), false);
  for (const Corners& corner : kept) {
    for (const std::int32_t v : corner) {
      used[at(v)] = true;
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
  std::map<Place, std::int32_t> place_of;
  for (std::int32_t v = 0; v < original.position_m.rows(); ++v) {
    place_of.try_emplace(place(original, v), v);
  }
  std::vector<std::int32_t> index;
  for (Eigen::Index v = 0; v < mesh.position_m.rows(); ++v) {
    const auto found = place_of.find(place(mesh, v));
    index.push_back(found == place_of.end() ? -1 : found->second);
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
