#include "precompute/surface/glued_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "formats/base/at.h"
#include "formats/base/reproducible.h"
#include "formats/mesh/angle_between.h"
#include "precompute/surface/disjoint_sets.h"
#include "precompute/surface/edge_key.h"
#include "precompute/surface/surface_parts.h"
#include "precompute/surface/winding_number.h"

namespace palpate {
namespace {

constexpr double kGapOfEdge = 1e-3;  // [-]

// Side j of triangle t, from corner j to the next, by its number 3 t + j.
struct TriangleSide {
  std::uint64_t edge = 0;
  std::int32_t number = 0;
};

std::int32_t next_corner(std::int32_t number) {
  return number - number % 3 + (number + 1) % 3;
}

std::int32_t vertex_of(const SurfaceMesh& mesh, std::int32_t corner) {
  return mesh.triangle(corner / 3, corner % 3);
}

// From the lower to the higher vertex.
bool upwards(const SurfaceMesh& mesh, const TriangleSide& side) {
  return vertex_of(mesh, side.number) < vertex_of(mesh, next_corner(side.number));
}

// Sides in the order of their edges.
std::vector<TriangleSide> sorted_sides(const SurfaceMesh& mesh) {
  std::vector<TriangleSide> sides;
  for (std::int32_t c = 0; c < 3 * mesh.triangle.rows(); ++c) {
    sides.push_back(
        {edge_key({vertex_of(mesh, c), vertex_of(mesh, next_corner(c))}), c});
  }
  std::sort(sides.begin(), sides.end(),
            [](const TriangleSide& a, const TriangleSide& b) {
              return std::pair(a.edge, a.number) < std::pair(b.edge, b.number);
            });
  return sides;
}

// The sides of each edge.
std::vector<std::span<TriangleSide>> by_edge(std::vector<TriangleSide>& sides) {
  std::vector<std::span<TriangleSide>> edges;
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i;
    while (end < sides.size() && sides[end].edge == sides[i].edge) {
      ++end;
    }
    edges.push_back(std::span(sides).subspan(i, end - i));
    i = end;
  }
  return edges;
}

bool any_edge_of_more(std::span<const std::span<TriangleSide>> edges) {
  return std::any_of(edges.begin(), edges.end(), [](const auto& edge) {
    return edge.size() > 2;
  });
}

// Whether the other two triangles at an edge of three go on into each other.
bool others_agree(const SurfaceMesh& mesh, std::span<const TriangleSide> edge,
                  std::int32_t triangle) {
  int up = 0;
  int others = 0;
  for (const TriangleSide& side : edge) {
    if (side.number / 3 != triangle) {
      ++others;
      up += upwards(mesh, side) ? 1 : 0;
    }
  }
  return others == 2 && up == 1;
}

// The triangles of a sheet that lies inside of the rest.
std::optional<std::vector<Eigen::Index>> inner_wall(const SurfaceMesh& mesh) {
  std::vector<TriangleSide> sides = sorted_sides(mesh);
  const std::vector<std::span<TriangleSide>> edges = by_edge(sides);
  if (!any_edge_of_more(edges)) {
    return std::nullopt;
  }
  Partition sheet(at(mesh.triangle.rows()));
  for (const std::span<TriangleSide> edge : edges) {
    if (edge.size() == 2) {
      sheet.join(edge[0].number / 3, edge[1].number / 3);
    }
  }
  std::map<std::int32_t, bool> ends_well;  // by sheet
  for (const std::span<TriangleSide> edge : edges) {
    for (const TriangleSide& side : edge) {
      const bool well = edge.size() == 3 && others_agree(mesh, edge, side.number / 3);
      if (edge.size() != 2) {
        const auto [place, first] =
            ends_well.try_emplace(sheet.find(side.number / 3), well);
        place->second = place->second && well;
      }
    }
  }
  for (const auto& [of, well] : ends_well) {
    if (!well) {
      continue;
    }
    std::vector<Eigen::Index> wall;
    std::vector<Eigen::Index> rest;
    for (std::int32_t t = 0; t < mesh.triangle.rows(); ++t) {
      (sheet.find(t) == of ? wall : rest).push_back(t);
    }
    const Eigen::Vector3d middle_m =
        mesh.position_m(mesh.triangle.row(wall.front()), Eigen::all)
            .colwise()
            .mean()
            .transpose();
    if (std::abs(winding_number(of_triangles(mesh, rest), middle_m)) > 0.5) {
      return rest;
    }
  }
  return std::nullopt;
}

// Joins the corners at both ends of two sides of one edge.
void join_ends(const SurfaceMesh& mesh, const TriangleSide& a, const TriangleSide& b,
               Partition& fan) {
  const std::int32_t a_next = next_corner(a.number);
  const std::int32_t b_next = next_corner(b.number);
  const bool alike = vertex_of(mesh, a.number) == vertex_of(mesh, b.number);
  fan.join(a.number, alike ? b.number : b_next);
  fan.join(a_next, alike ? b_next : b.number);
}

// Sorts the sides of an edge by the angle of their triangles about it, right-handed
// from its lower to its higher vertex.
void sort_about(const SurfaceMesh& mesh, std::span<TriangleSide> edge) {
  const auto point = [&](std::int32_t corner) -> Eigen::Vector3d {
    return mesh.position_m.row(vertex_of(mesh, corner)).transpose();
  };
  const std::int32_t from = edge[0].number;
  const Eigen::Vector3d start = point(from);
  const Eigen::Vector3d along = (upwards(mesh, edge[0]) ? 1.0 : -1.0) *
                                (point(next_corner(from)) - start).normalized();
  const Eigen::Vector3d x = along.unitOrthogonal();
  const Eigen::Vector3d y = along.cross(x);
  const auto angle = [&](const TriangleSide& side) {
    const Eigen::Vector3d to = point(next_corner(next_corner(side.number))) - start;
    return reproducible::atan2(to.dot(y), to.dot(x));
  };
  std::sort(edge.begin(), edge.end(),
            [&](const TriangleSide& a, const TriangleSide& b) {
              return angle(a) < angle(b);
            });
}

// At an edge of more than two triangles those with the body between them belong
// together. Of one that runs up the edge the body is behind, at smaller angles.
void join_about(const SurfaceMesh& mesh, bool inside_out, std::span<TriangleSide> edge,
                Partition& fan) {
  sort_about(mesh, edge);
  bool by_turns = true;
  for (std::size_t i = 0; i < edge.size(); ++i) {
    by_turns = by_turns &&
               upwards(mesh, edge[i]) != upwards(mesh, edge[(i + 1) % edge.size()]);
  }
  for (std::size_t i = 0; i < edge.size(); ++i) {
    if (!by_turns || upwards(mesh, edge[i]) == inside_out) {
      join_ends(mesh, edge[i], edge[(i + 1) % edge.size()], fan);
    }
  }
}

// What a vertex's triangles say of a copy of it: which way is out, and how far to go.
struct Copy {
  std::int32_t vertex = 0;
  Eigen::Vector3d outward = Eigen::Vector3d::Zero();
  double shortest_m = 0.0;
};

void add_corner(const SurfaceMesh& mesh, std::int32_t corner, Copy& copy) {
  const auto point = [&](std::int32_t c) -> Eigen::Vector3d {
    return mesh.position_m.row(vertex_of(mesh, c)).transpose();
  };
  const Eigen::Vector3d a = point(next_corner(corner)) - point(corner);
  const Eigen::Vector3d b = point(next_corner(next_corner(corner))) - point(corner);
  copy.outward += angle_between(a, b) * a.cross(b).normalized();
  const double shorter_m = std::min(a.norm(), b.norm());
  copy.shortest_m =
      copy.shortest_m > 0.0 ? std::min(copy.shortest_m, shorter_m) : shorter_m;
}

}  // namespace

SurfaceMesh without_inner_walls(const SurfaceMesh& mesh, std::size_t& walls) {
  SurfaceMesh result = mesh;
  while (std::optional<std::vector<Eigen::Index>> rest = inner_wall(result)) {
    result = of_triangles(result, std::move(*rest));
    ++walls;
  }
  return result;
}

SurfaceMesh part_touching(const SurfaceMesh& mesh, std::size_t& added) {
  std::vector<TriangleSide> sides = sorted_sides(mesh);
  const std::vector<std::span<TriangleSide>> edges = by_edge(sides);
  if (std::any_of(edges.begin(), edges.end(), [](const auto& edge) {
        return edge.size() % 2 == 1;
      })) {
    return mesh;
  }
  const double inward = enclosed_volume_m3(mesh) < 0.0 ? 1.0 : -1.0;
  Partition fan(sides.size());
  for (const std::span<TriangleSide> edge : edges) {
    if (edge.size() == 2) {
      join_ends(mesh, edge[0], edge[1], fan);
    } else {
      join_about(mesh, inward > 0.0, edge, fan);
    }
  }
  // The fan that keeps each vertex; the others get copies.
  std::vector<std::int32_t> first(at(mesh.position_m.rows()), -1);
  std::map<std::int32_t, Copy> copy;  // by fan
  for (std::int32_t c = 0; c < std::ssize(sides); ++c) {
    std::int32_t& owner = first[at(vertex_of(mesh, c))];
    owner = owner < 0 ? fan.find(c) : owner;
    if (owner != fan.find(c)) {
      Copy& own = copy[fan.find(c)];
      own.vertex = vertex_of(mesh, c);
      add_corner(mesh, c, own);
    }
  }
  SurfaceMesh result = mesh;
  std::map<std::int32_t, std::int32_t> number;
  result.position_m.conservativeResize(mesh.position_m.rows() + std::ssize(copy), 3);
  for (const auto& [of, own] : copy) {
    const auto v = static_cast<std::int32_t>(mesh.position_m.rows()) +
                   static_cast<std::int32_t>(number.size());
    number[of] = v;
    result.position_m.row(v) =
        mesh.position_m.row(own.vertex) +
        inward * kGapOfEdge * own.shortest_m * own.outward.normalized().transpose();
  }
  for (std::int32_t c = 0; c < std::ssize(sides); ++c) {
    if (const auto place = number.find(fan.find(c)); place != number.end()) {
      result.triangle(c / 3, c % 3) = place->second;
    }
  }
  added += copy.size();
  return result;
}

}  // namespace palpate
