#include "precompute/body/body_surface.h"

#include <algorithm>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/body/meshed_body.h"
#include "precompute/body/scene_body.h"
#include "precompute/surface/refine_surface.h"

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

}  // namespace

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
    if (held(scene, part_mesh(checked.mesh, parts[i]))) {
      continue;
    }
    throw InputError(fmt::format(
        "{}: no support holds part {} of {}, {} triangles and {:.3g} m^3 about {} m: "
        "{}",
        scene.mesh.filename().string(), i + 1, parts.size(), parts[i].triangle.size(),
        std::abs(parts[i].volume_m3), place_text(parts[i].middle_m),
        parts[i].speck ? "--repair=safe leaves out such a speck"
                       : "add a [[support]] that reaches it, or take it out of the "
                         "mesh"));
  }
}

}  // namespace palpate
