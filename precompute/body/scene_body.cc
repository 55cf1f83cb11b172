#include "precompute/body/scene_body.h"

#include <algorithm>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/mesh/surface_reader.h"
#include "precompute/material/material_of_scene.h"
#include "precompute/surface/primitive_bodies.h"
#include "precompute/surface/split_at.h"
#include "precompute/surface/surface_check.h"
#include "precompute/tets/quality_notes.h"

namespace palpate {
namespace {

SurfaceMesh read_mesh(const Scene& scene, RepairMode repair,
                      std::vector<std::string>& notes) {
  CheckedSurface checked = require_body(read_surface(scene.mesh, scene.length_unit),
                                        repair, scene.mesh.string(), notes);
  if (checked.report.components_turned > 0) {
    notes.push_back(fmt::format("{}: the surface was inside out and has been turned",
                                scene.mesh.filename().string()));
  }
  if (checked.report.components > 1) {
    notes.push_back(fmt::format("{}: {} separate parts", scene.mesh.filename().string(),
                                checked.report.components));
  }
  for (const std::string& note : quality_notes(checked.report)) {
    notes.push_back(note);
  }
  return std::move(checked.mesh);
}

// A tool that the body cannot hold, or a press right through it, is a slip of units.
void check_size(const Scene& scene, const BodySource& body) {
  const double extent = bounding_box(body.surface).diagonal().norm();
  for (const auto& tool : body.tool) {
    const double width = tool->extent_m();
    if (width > 20.0 * extent) {
      throw InputError(fmt::format(
          "tool \"{}\" is more than 20 times larger than the body: diameter "
          "{} m, the body's extent is {} m; is length_unit = \"{}\" right?",
          tool->shape().name, width, extent, scene.length_unit));
    }
  }
  if (scene.reach.depth_max_m > extent) {
    throw InputError(
        fmt::format("reach.depth_max_m = {} m is more than the body's extent of {} m; "
                    "is length_unit = \"{}\" right?",
                    scene.reach.depth_max_m, extent, scene.length_unit));
  }
}

const SceneMaterial& scene_material(const Scene& scene, std::string_view region) {
  const auto at = std::find_if(scene.material.begin(), scene.material.end(),
                               [&](const SceneMaterial& m) {
                                 return m.region == region;
                               });
  if (at == scene.material.end()) {
    throw InputError(
        fmt::format("the scene has no [[material]] with region = {:?}", region));
  }
  return *at;
}

InnerSurface inner_surface(const SceneInclusion& inclusion) {
  constexpr double kEdgeOfRadius = 0.5;  // an icosphere of 42 or 162 vertices
  InnerSurface inner{.cavity = inclusion.cavity, .name = inclusion.name};
  if (inclusion.sphere) {
    const SceneBall& ball = *inclusion.sphere;
    inner.surface =
        sphere_surface(ball.center_m, ball.radius_m, kEdgeOfRadius * ball.radius_m);
  } else {
    const SceneMesh& mesh = *inclusion.mesh;
    inner.surface =
        require_body(read_surface(mesh.file, mesh.length_unit), mesh.file.string())
            .mesh;
  }
  return inner;
}

void read_inclusions(const Scene& scene, BodySource& body) {
  body.material = materials_of(scene);
  for (const SceneInclusion& inclusion : scene.inclusion) {
    body.inner.push_back(inner_surface(inclusion));
    if (inclusion.mesh) {
      body.files.push_back(inclusion.mesh->file);
    }
  }
  body.inner = check_inner_surfaces(body.surface, body.inner);
}

}  // namespace

std::vector<Material> materials_of(const Scene& scene) {
  std::vector<Material> materials{make_material(scene_material(scene, kBodyRegion))};
  for (const SceneInclusion& inclusion : scene.inclusion) {
    // A cavity has no tets; its material is never asked for.
    materials.push_back(inclusion.cavity
                            ? materials.front()
                            : make_material(scene_material(scene, inclusion.name)));
  }
  return materials;
}

BodySource read_body(const Scene& scene, RepairMode repair) {
  BodySource body;
  body.surface = read_mesh(scene, repair, body.notes);
  body.files.push_back(scene.mesh);
  body.normal = vertex_normals(body.surface);
  body.held = held_points(body.surface, [&](const Eigen::Vector3d& p_m) {
    return is_held(scene, p_m);
  });
  read_inclusions(scene, body);
  for (std::size_t i = 0; i < scene.tool.size(); ++i) {
    ToolShape tool = scene.tool[i];
    if (tool.kind == "mesh") {
      const SceneMesh& mesh = scene.tool_mesh[i];
      tool.mesh = read_surface(mesh.file, mesh.length_unit);
      body.files.push_back(mesh.file);
    }
    body.tool.push_back(std::make_shared<const ToolSurface>(tool));
  }
  check_size(scene, body);
  return body;
}

BodySource with_vertex_at(const BodySource& body, const SurfacePoint& place) {
  BodySource more = body;
  more.surface = split_at(body.surface, place);
  Eigen::RowVector3d normal = Eigen::RowVector3d::Zero();
  for (int j = 0; j < 3; ++j) {
    normal += place.area_coordinate(j) *
              body.normal.row(body.surface.triangle(place.triangle, j));
  }
  more.normal.conservativeResize(more.surface.position_m.rows(), 3);
  more.normal.row(more.normal.rows() - 1) = normal.normalized();
  return more;
}

bool is_held(const Scene& scene, const Eigen::Vector3d& p_m) {
  return std::any_of(scene.support.begin(), scene.support.end(),
                     [&](const SceneSupport& support) {
                       return support.is_fixed() && holds(support, p_m);
                     });
}

std::vector<std::int32_t> reachable_vertices(const Scene& scene,
                                             const BodySource& body) {
  std::vector<std::int32_t> vertices;
  for (Eigen::Index v = 0; v < body.surface.position_m.rows(); ++v) {
    const Eigen::Vector3d p = body.surface.position_m.row(v).transpose();
    const bool in_reach = !scene.reach.box_m || scene.reach.box_m->contains(p);
    if (!is_held(scene, p) && in_reach) {
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
