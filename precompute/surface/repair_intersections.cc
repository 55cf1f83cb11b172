#include "precompute/surface/repair_intersections.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "formats/base/at.h"
#include "precompute/surface/disjoint_sets.h"
#include "precompute/surface/repair_topology.h"
#include "precompute/surface/self_intersections.h"
#include "precompute/surface/surface_check.h"
#include "precompute/surface/surface_soup.h"

namespace palpate {
namespace {

using Pairs = std::vector<std::pair<std::int32_t, std::int32_t>>;

constexpr int kRingsMax = 4;    // a wider cut moves the surface too far
constexpr int kPassesMax = 20;  // of some seconds each on a surface of 50 000 triangles

double area_m2(const SurfaceMesh& mesh, std::int32_t t) {
  const Eigen::Matrix3d corner = mesh.position_m(mesh.triangle.row(t), Eigen::all);
  return 0.5 *
         (corner.row(1) - corner.row(0)).cross(corner.row(2) - corner.row(0)).norm();
}

// Which triangles of a closed manifold are to be taken out.
class Cut {
 public:
  explicit Cut(const SurfaceMesh& mesh)
      : mesh_(mesh),
        neighbour_(triangle_neighbours(mesh.triangle)),
        triangles_(static_cast<std::int32_t>(mesh.triangle.rows())),
        vertices_(at(static_cast<std::int32_t>(mesh.position_m.rows()))),
        out_(at(triangles_), false) {}

  void add(std::int32_t triangle) { out_[at(triangle)] = true; }

  // The triangles that share a vertex with those that are out.
  void add_ring() {
    std::vector<bool> touched(vertices_, false);
    for (std::int32_t t = 0; t < triangles_; ++t) {
      for (int j = 0; out_[at(t)] && j < 3; ++j) {
        touched[at(mesh_.triangle(t, j))] = true;
      }
    }
    add_around(touched);
  }

  // What stays must have one fan of triangles at each vertex: else all of them go.
  void add_pinched() {
    for (bool pinched = true; pinched;) {
      pinched = false;
      std::vector<bool> rim(vertices_, false);
      std::vector<bool> twice(vertices_, false);
      for (std::int32_t t = 0; t < triangles_; ++t) {
        for (int j = 0; !out_[at(t)] && j < 3; ++j) {
          if (out_[at(neighbour_(t, j))]) {  // a fan has one such edge that starts here
            const std::size_t v = at(mesh_.triangle(t, j));
            twice[v] = rim[v];
            pinched = pinched || rim[v];
            rim[v] = true;
          }
        }
      }
      add_around(twice);
    }
  }

  // Of each component, only the largest part stays.
  void add_islands() {
    Partition component(vertices_);
    Partition part(vertices_);
    for (std::int32_t t = 0; t < triangles_; ++t) {
      join_corners(component, t);
      if (!out_[at(t)]) {
        join_corners(part, t);
      }
    }
    std::vector<double> area(vertices_, 0.0);
    for (std::int32_t t = 0; t < triangles_; ++t) {
      if (!out_[at(t)]) {
        area[at(part.find(mesh_.triangle(t, 0)))] += area_m2(mesh_, t);
      }
    }
    std::vector<std::int32_t> largest(vertices_, -1);
    for (std::int32_t v = 0; v < std::ssize(area); ++v) {
      std::int32_t& best = largest[at(component.find(v))];
      if (best < 0 || area[at(v)] > area[at(best)]) {
        best = v;
      }
    }
    for (std::int32_t t = 0; t < triangles_; ++t) {
      const std::int32_t v = mesh_.triangle(t, 0);
      out_[at(t)] = out_[at(t)] || part.find(v) != largest[at(component.find(v))];
    }
  }

  // What stays, with its holes filled.
  [[nodiscard]] SurfaceMesh filled() const {
    SurfaceMesh open = mesh_;
    Eigen::Index kept = 0;
    for (std::int32_t t = 0; t < triangles_; ++t) {
      if (!out_[at(t)]) {
        open.triangle.row(kept++) = mesh_.triangle.row(t);
      }
    }
    open.triangle.conservativeResize(kept, 3);
    SoupChanges vertices_gone;
    TopologyChanges holes_filled;
    return close_holes(clean_soup(open, vertices_gone), holes_filled);
  }

 private:
  void add_around(const std::vector<bool>& vertex) {
    for (std::int32_t t = 0; t < triangles_; ++t) {
      for (int j = 0; j < 3; ++j) {
        out_[at(t)] = out_[at(t)] || vertex[at(mesh_.triangle(t, j))];
      }
    }
  }

  void join_corners(Partition& sets, std::int32_t t) const {
    sets.join(mesh_.triangle(t, 0), mesh_.triangle(t, 1));
    sets.join(mesh_.triangle(t, 0), mesh_.triangle(t, 2));
  }

  const SurfaceMesh& mesh_;
  Triangles neighbour_;
  std::int32_t triangles_;
  std::size_t vertices_;
  std::vector<bool> out_;
};

// Whether only crossings keep the surface from being a body of so many components.
bool sound(const SurfaceMesh& mesh, Eigen::Index components) {
  SurfaceReport report = check_surface(mesh).report;
  report.self_intersections = {};
  return report.accepted() && report.components == components;
}

// Crossing triangles cut out with rings around them, and the holes filled.
SurfaceMesh refilled(const SurfaceMesh& mesh, const Pairs& crossing, int rings) {
  Cut cut(mesh);
  for (const auto& [a, b] : crossing) {
    cut.add(a);
    cut.add(b);
  }
  for (int ring = 0; ring < rings; ++ring) {
    cut.add_ring();
  }
  cut.add_pinched();
  cut.add_islands();
  return cut.filled();
}

}  // namespace

SurfaceMesh repair_intersections(const SurfaceMesh& mesh) {
  Pairs crossing = self_intersections(mesh);
  if (crossing.empty()) {
    return mesh;
  }
  const Eigen::Index components = check_surface(mesh).report.components;
  SurfaceMesh best = mesh;
  int rings = 0;
  for (int pass = 0; pass < kPassesMax && rings <= kRingsMax && !crossing.empty();
       ++pass) {
    SurfaceMesh next = refilled(best, crossing, rings);
    Pairs left = self_intersections(next);
    if (left.size() < crossing.size() && sound(next, components)) {
      best = std::move(next);
      crossing = std::move(left);
      rings = 0;
    } else {
      ++rings;
    }
  }
  return best;
}

}  // namespace palpate
