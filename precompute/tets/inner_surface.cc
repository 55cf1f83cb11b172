#include "precompute/tets/inner_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/surface/disjoint_sets.h"
#include "precompute/surface/self_intersections.h"
#include "precompute/surface/surface_check.h"
#include "precompute/surface/winding_number.h"

namespace palpate {
namespace {

// The outer surface, then the inner ones, in one mesh; where the triangles of each end.
struct Joined {
  SurfaceMesh mesh;
  std::vector<Eigen::Index> end;

  // 0: the outer surface; i + 1: inner surface i.
  [[nodiscard]] std::size_t owner(std::int32_t t) const {
    return static_cast<std::size_t>(std::upper_bound(end.begin(), end.end(), t) -
                                    end.begin());
  }
};

void append_surface(const SurfaceMesh& part, Joined& joined) {
  SurfaceMesh& mesh = joined.mesh;
  const Eigen::Index vertices = mesh.position_m.rows();
  mesh.position_m.conservativeResize(vertices + part.position_m.rows(), 3);
  mesh.position_m.bottomRows(part.position_m.rows()) = part.position_m;
  const Eigen::Index triangles = mesh.triangle.rows();
  mesh.triangle.conservativeResize(triangles + part.triangle.rows(), 3);
  mesh.triangle.bottomRows(part.triangle.rows()) =
      part.triangle.array() + static_cast<std::int32_t>(vertices);
  joined.end.push_back(mesh.triangle.rows());
}

// Pairs of surfaces that touch or cross, 0 the outer one, and a triangle where.
struct Meeting {
  std::size_t first = 0;
  std::size_t second = 0;
  Eigen::Vector3d at_m;
};

std::vector<Meeting> meetings(const SurfaceMesh& outer,
                              std::span<const InnerSurface> inner) {
  Joined joined;
  append_surface(outer, joined);
  for (const InnerSurface& one : inner) {
    append_surface(one.cut ? SurfaceMesh{} : one.surface, joined);
  }
  std::vector<Meeting> found;
  for (const auto& [a, b] : self_intersections(joined.mesh)) {
    const std::size_t first = joined.owner(a);
    const std::size_t second = joined.owner(b);
    if (first != second) {
      found.push_back({first, second, triangle_middle_m(joined.mesh, b)});
    }
  }
  return found;
}

[[noreturn]] void refuse(std::span<const InnerSurface> inner, const Meeting& meeting) {
  throw InputError(fmt::format(
      "{} touches or crosses {} at {} m; surfaces in a body must keep apart",
      inner_surface_name(inner, meeting.second - 1),
      meeting.first == 0 ? "the body's surface"
                         : inner_surface_name(inner, meeting.first - 1),
      place_text(meeting.at_m)));
}

// One vertex of each part.
std::vector<std::int32_t> part_vertices(const SurfaceMesh& mesh) {
  Partition part(static_cast<std::size_t>(mesh.position_m.rows()));
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    part.join(mesh.triangle(t, 0), mesh.triangle(t, 1));
    part.join(mesh.triangle(t, 0), mesh.triangle(t, 2));
  }
  std::vector<std::int32_t> vertices;
  for (std::int32_t v = 0; v < mesh.position_m.rows(); ++v) {
    if (part.find(v) == v) {
      vertices.push_back(v);
    }
  }
  return vertices;
}

// The surfaces keep apart, so that one vertex tells for all of a part.
void check_place(const SurfaceMesh& outer, std::span<const InnerSurface> inner,
                 std::size_t i) {
  const SurfaceMesh& surface = inner[i].surface;
  for (const std::int32_t v : part_vertices(surface)) {
    const Eigen::Vector3d at_m = surface.position_m.row(v).transpose();
    // How many of the body's parts are around it, less cavities that are.
    double parts = winding_number(outer, at_m);
    if (parts < 0.5) {
      throw InputError(fmt::format("{} is outside of the body: its vertex {} at {} m",
                                   inner_surface_name(inner, i), v, place_text(at_m)));
    }
    for (std::size_t j = 0; j < inner.size(); ++j) {
      parts -= j != i && inner[j].cavity ? winding_number(inner[j].surface, at_m) : 0.0;
      if (parts < 0.5) {
        throw InputError(
            fmt::format("{} floats in the cavity of {}: its vertex {} at {} m",
                        inner_surface_name(inner, i), inner_surface_name(inner, j), v,
                        place_text(at_m)));
      }
    }
  }
}

}  // namespace

std::string inner_surface_name(std::span<const InnerSurface> inner, std::size_t i) {
  return inner[i].name.empty() ? fmt::format("inner surface {}", i + 1)
                               : fmt::format("inner surface \"{}\"", inner[i].name);
}

void mark_cut(const SurfaceMesh& outer, std::span<InnerSurface> inner) {
  std::vector<bool> meets(inner.size(), false);
  for (const Meeting& meeting : meetings(outer, inner)) {
    for (const std::size_t of : {meeting.first, meeting.second}) {
      if (of > 0 && inner[of - 1].cavity) {
        refuse(inner, meeting);
      }
      if (of > 0) {
        meets[of - 1] = true;
      }
    }
  }
  for (std::size_t i = 0; i < inner.size(); ++i) {
    inner[i].cut = inner[i].cut || meets[i];
  }
}

std::vector<InnerSurface> check_inner_surfaces(const SurfaceMesh& outer,
                                               std::span<const InnerSurface> inner) {
  std::vector<InnerSurface> checked(inner.begin(), inner.end());
  if (checked.empty()) {
    return checked;
  }
  for (std::size_t i = 0; i < checked.size(); ++i) {
    if (checked[i].cut) {
      continue;
    }
    checked[i].surface =
        require_body(std::move(checked[i].surface), inner_surface_name(inner, i)).mesh;
  }
  for (const Meeting& meeting : meetings(outer, checked)) {
    refuse(checked, meeting);
  }
  for (std::size_t i = 0; i < checked.size(); ++i) {
    if (!checked[i].cut) {
      check_place(outer, checked, i);
    }
  }
  return checked;
}

}  // namespace palpate
