#include "precompute/body_source.h"

#include <algorithm>

#include <fmt/format.h>

#include "formats/error.h"
#include "precompute/surface_check.h"
#include "precompute/surface_reader.h"

namespace palpate {
namespace {

SurfaceMesh read_mesh(const Scene& scene, std::vector<std::string>& notes) {
  CheckedSurface checked =
      require_body(read_surface(scene.mesh, scene.length_unit), scene.mesh.string());
  if (checked.report.components_turned > 0) {
    notes.push_back(fmt::format("{}: the surface was inside out and has been turned",
                                scene.mesh.filename().string()));
  }
  if (checked.report.components > 1) {
    notes.push_back(fmt::format("{}: {} separate parts", scene.mesh.filename().string(),
                                checked.report.components));
  }
  return std::move(checked.mesh);
}

// A tool that the body cannot hold, or a press right through it, is a slip of units.
void check_size(const Scene& scene, const SurfaceMesh& surface) {
  const double extent = bounding_box(surface).diagonal().norm();
  for (const ToolShape& tool : scene.tool) {
    if (2.0 * tool.radius_m > 20.0 * extent) {
      throw InputError(fmt::format(
          "tool \"{}\" is more than 20 times larger than the body: diameter "
          "{} m, the body's extent is {} m; is length_unit = \"{}\" right?",
          tool.name, 2.0 * tool.radius_m, extent, scene.length_unit));
    }
  }
  if (scene.reach.depth_max_m > extent) {
    throw InputError(
        fmt::format("reach.depth_max_m = {} m is more than the body's extent of {} m; "
                    "is length_unit = \"{}\" right?",
                    scene.reach.depth_max_m, extent, scene.length_unit));
  }
}

Material body_material(const Scene& scene) {
  const auto at = std::find_if(scene.material.begin(), scene.material.end(),
                               [](const SceneMaterial& m) {
                                 return m.region == "body";
                               });
  if (at == scene.material.end()) {
    throw InputError("the scene has no [[material]] with region = \"body\"");
  }
  if (at->law == "neo-hookean") {
    return neo_hookean(at->youngs_modulus_pa, at->poissons_ratio);
  }
  return linear(at->youngs_modulus_pa, at->poissons_ratio);
}

}  // namespace

BodySource read_body(const Scene& scene) {
  BodySource body;
  body.surface = read_mesh(scene, body.notes);
  check_size(scene, body.surface);
  body.normal = vertex_normals(body.surface);
  body.material.push_back(body_material(scene));
  return body;
}

std::vector<std::int32_t> reachable_vertices(const Scene& scene,
                                             const BodySource& body) {
  std::vector<std::int32_t> vertices;
  for (Eigen::Index v = 0; v < body.surface.position_m.rows(); ++v) {
    const Eigen::Vector3d p = body.surface.position_m.row(v).transpose();
    const bool held = std::any_of(scene.support.begin(), scene.support.end(),
                                  [&](const SceneSupport& support) {
                                    return holds(support, p);
                                  });
    const bool in_reach = !scene.reach.box_m || scene.reach.box_m->contains(p);
    if (!held && in_reach) {
      vertices.push_back(static_cast<std::int32_t>(v));
    }
  }
  if (vertices.empty()) {
    throw InputError(
        "no vertex of the body is both in reach and free: reach.box_m misses the body, "
        "or the supports hold all of it");
  }
  return vertices;
}

}  // namespace palpate
