#include "precompute/body/body_surface.h"

#include <algorithm>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "formats/base/at.h"
#include "formats/base/error.h"
#include "formats/mesh/surface_reader.h"
#include "precompute/body/meshed_body.h"
#include "precompute/body/scene_body.h"
#include "precompute/surface/refine_surface.h"
#include "precompute/surface/surface_distance.h"

namespace palpate {
namespace {

constexpr double kEdgeOfReach = 0.125;
constexpr double kGrowth = 0.5;

bool any_vertex_to_press(const Scene& scene, const SurfaceMesh& surface) {
  for (Eigen::Index v = 0; v < surface.position_m.rows(); ++v) {
    if (is_reachable(scene, surface.position_m.row(v).transpose())) {
      return true;
    }
  }
  return false;
}

bool held(const Scene& scene, const SurfaceMesh& part) {
  for (const double area_m2 : supported_areas_m2(scene, part)) {
    if (area_m2 > 0.0) {
      return true;
    }
  }
  for (Eigen::Index v = 0; v < part.position_m.rows(); ++v) {
    if (std::any_of(scene.support.begin(), scene.support.end(),
                    [&](const SceneSupport& support) {
                      return holds(support, part.position_m.row(v).transpose());
                    })) {
      return true;
    }
  }
  return false;
}

// How far faces lie apart that an inclusion and the body share: SCENE.md.
double shared_within_m(const SurfaceMesh& body, const SurfaceMesh& inclusion) {
  constexpr double kOfDiagonal = 1.0 / 500.0;
  constexpr double kOfThickness = 0.2;
  const double thickness_m =
      2.0 * std::abs(enclosed_volume_m3(inclusion)) / surface_area_m2(inclusion);
  return std::min(kOfDiagonal * bounding_box(body).diagonal().norm(),
                  kOfThickness * thickness_m);
}

bool coincide(const SurfaceMesh& a, const SurfaceMesh& b, double within_m) {
  const Eigen::AlignedBox3d box_a = bounding_box(a);
  const Eigen::AlignedBox3d box_b = bounding_box(b);
  return (box_a.min() - box_b.min()).norm() <= 2.0 * within_m &&
         (box_a.max() - box_b.max()).norm() <= 2.0 * within_m &&
         distance_to_surface_m(a, b) <= within_m &&
         distance_to_surface_m(b, a) <= within_m;
}

bool in_another_box(const std::vector<SurfaceMesh>& part, std::size_t i) {
  for (std::size_t j = 0; j < part.size(); ++j) {
    if (j != i && bounding_box(part[j]).contains(bounding_box(part[i]))) {
      return true;
    }
  }
  return false;
}

void add_triangles(const SurfacePart& part, std::vector<Eigen::Index>& triangle) {
  triangle.insert(triangle.end(), part.triangle.begin(), part.triangle.end());
}

}  // namespace

SurfaceMesh read_body_mesh(const Scene& scene, std::vector<std::string>& notes) {
  SurfaceMesh mesh = read_surface(scene.mesh, scene.length_unit, &notes);
  if (scene.inclusion.empty()) {
    return mesh;
  }
  const std::vector<SurfacePart> parts = surface_parts(mesh);
  std::vector<SurfaceMesh> part;
  for (const SurfacePart& one : parts) {
    part.push_back(part_mesh(mesh, one));
  }
  std::vector<bool> named(parts.size(), false);
  // A part of the body's own mesh may be an inclusion's surface. The inclusion brings
  // that surface itself, so that the part is left out of the body's.
  for (const SceneInclusion& inclusion : scene.inclusion) {
    if (parts.size() < 2 || !inclusion.mesh) {
      continue;
    }
    const SurfaceMesh wall =
        read_surface(inclusion.mesh->file, inclusion.mesh->length_unit);
    const double within_m = shared_within_m(mesh, wall);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (!named[i] && coincide(part[i], wall, within_m) && in_another_box(part, i)) {
        named[i] = true;
        notes.push_back(
            fmt::format("{}: the part about {} m is the surface of inclusion \"{}\"",
                        scene.mesh.filename().string(), place_text(parts[i].middle_m),
                        inclusion.name));
      }
    }
  }
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!named[i]) {
      add_triangles(parts[i], kept);
    }
  }
  return std::ssize(kept) == mesh.triangle.rows() ? mesh
                                                  : of_triangles(mesh, std::move(kept));
}

HollowBody take_cavities(const Scene& scene, const CheckedSurface& checked) {
  HollowBody body;
  std::vector<Eigen::Index> kept;
  for (const SurfacePart& part : checked.report.part) {
    if (part.is_cavity()) {
      SurfaceMesh wall = of_triangles(checked.mesh, part.triangle);
      wall.triangle.col(1).swap(wall.triangle.col(2));
      body.cavity.push_back(
          {.surface = std::move(wall),
           .cavity = true,
           .name = fmt::format("cavity {} of {}", body.cavity.size() + 1,
                               scene.mesh.filename().string())});
    } else {
      add_triangles(part, kept);
    }
  }
  body.surface =
      body.cavity.empty() ? checked.mesh : of_triangles(checked.mesh, std::move(kept));
  return body;
}

bool is_reachable(const Scene& scene, const Eigen::Vector3d& p_m) {
  return !is_held(scene, p_m) &&
         (!scene.reach.box_m || scene.reach.box_m->contains(p_m));
}

SurfaceMesh refined_for_reach(const Scene& scene, SurfaceMesh surface,
                              std::vector<std::string>& notes) {
  if (any_vertex_to_press(scene, surface)) {
    return surface;
  }
  const Eigen::AlignedBox3d body = bounding_box(surface);
  const Eigen::AlignedBox3d reach =
      scene.reach.box_m ? body.intersection(*scene.reach.box_m) : body;
  if (reach.isEmpty() || !(reach.diagonal().norm() > 0.0)) {
    return surface;
  }
  // The reach has no vertex to press. Edges of an eighth of the reach's diagonal make
  // some; outside of the reach edges may grow with distance.
  const double edge_m = kEdgeOfReach * reach.diagonal().norm();
  SurfaceMesh fine = refine_longest_edge(
      surface,
      [&](const Eigen::Vector3d& p_m) {
        return std::max(edge_m, kGrowth * reach.exteriorDistance(p_m));
      },
      kMostTriangles);
  if (fine.triangle.rows() == surface.triangle.rows() ||
      !any_vertex_to_press(scene, fine)) {
    return surface;
  }
  notes.push_back(fmt::format(
      "the surface is too coarse to be pressed as it is: where the scene reaches, its "
      "edges were halved to {:.3g} m or less, an eighth of the reach: {} vertices "
      "became {}; for others, palpate-precompute remesh MESH --edge-m LENGTH -o OUT",
      edge_m, surface.position_m.rows(), fine.position_m.rows()));
  return fine;
}

void require_held_parts(const Scene& scene, const CheckedSurface& checked) {
  const std::vector<SurfacePart>& parts = checked.report.part;
  for (std::size_t i = 0; parts.size() > 1 && i < parts.size(); ++i) {
    if (parts[i].is_cavity() || held(scene, part_mesh(checked.mesh, parts[i]))) {
      continue;
    }
    throw InputError(fmt::format(
        "{}: no support holds part {} of {}, {} triangles and {:.3g} m^3 about {} m{}: "
        "{}",
        scene.mesh.filename().string(), i + 1, parts.size(), parts[i].triangle.size(),
        std::abs(parts[i].volume_m3), place_text(parts[i].middle_m),
        parts[i].around > 0 ? ", which lies in a cavity" : "",
        parts[i].speck ? "--repair=safe leaves out such a speck"
                       : "add a [[support]] that reaches it, or take it out of the "
                         "mesh"));
  }
}

}  // namespace palpate
