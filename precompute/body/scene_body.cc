#include "precompute/body/scene_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/mesh/surface_reader.h"
#include "precompute/body/body_surface.h"
#include "precompute/material/material_of_scene.h"
#include "precompute/surface/primitive_bodies.h"
#include "precompute/surface/split_at.h"
#include "precompute/surface/surface_check.h"
#include "precompute/tets/cut_regions.h"
#include "precompute/tets/quality_notes.h"

namespace palpate {
namespace {

HollowBody read_hollow_body(const Scene& scene, RepairMode repair,
                            std::vector<std::string>& notes) {
  const SurfaceMesh read = read_body_mesh(scene, notes);
  const CheckedSurface checked = require_body(read, repair, scene.mesh.string(), notes);
  const Eigen::Index cavities = checked.report.cavities();
  if (checked.report.components_turned > 0) {
    notes.push_back(fmt::format("{}: the surface was inside out and has been turned",
                                scene.mesh.filename().string()));
  }
  if (checked.report.components - cavities > 1) {
    notes.push_back(fmt::format("{}: {} separate parts", scene.mesh.filename().string(),
                                checked.report.components - cavities));
  }
  if (cavities > 0) {
    notes.push_back(fmt::format("{}: {} of its parts lie inside another: cavities",
                                scene.mesh.filename().string(), cavities));
  }
  for (const std::string& note : quality_notes(checked.report)) {
    notes.push_back(note);
  }
  require_held_parts(scene, checked);
  HollowBody body = take_cavities(scene, checked);
  body.surface = refined_for_reach(scene, std::move(body.surface), notes);
  return body;
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
  if (inclusion.under_m) {
    inner.cut = true;
    inner.under_m = *inclusion.under_m;
  } else if (inclusion.sphere) {
    const SceneBall& ball = *inclusion.sphere;
    inner.surface =
        sphere_surface(ball.center_m, ball.radius_m, kEdgeOfRadius * ball.radius_m);
  } else {
    const SceneMesh& mesh = *inclusion.mesh;
    CheckedSurface checked =
        require_body(read_surface(mesh.file, mesh.length_unit), mesh.file.string());
    if (checked.report.cavities() > 0) {
      throw InputError(fmt::format(
          "{}: inclusion {:?} has a part inside another part, which would be empty: "
          "give that part a mesh and an [[inclusion]] of its own (cavity = true if it "
          "is one)",
          mesh.file.string(), inclusion.name));
    }
    inner.surface = std::move(checked.mesh);
  }
  return inner;
}

// What of inclusions that reach the surface lies outside of the body is left out.
void check_left_out(BodySource& body) {
  constexpr double kMost = 0.5;
  constexpr double kSaid = 0.05;  // share_outside() tells it to 0.03
  for (std::size_t i = 0; i < body.inner.size(); ++i) {
    if (!body.inner[i].cut) {
      continue;
    }
    const double share = share_left_out(body.surface, body.inner[i]);
    const std::string name = inner_surface_name(body.inner, i);
    if (share > kMost) {
      throw InputError(fmt::format(
          "{} lies outside of the body by {:.0f} % of its volume, at most half is left "
          "out: is its length_unit right, and its place?",
          name, 100.0 * share));
    }
    body.notes.push_back(
        share > kSaid
            ? fmt::format("{} reaches out of the body: {:.0f} % of it is left out",
                          name, 100.0 * share)
            : fmt::format("{} shares faces with the body's surface or other parts",
                          name));
  }
}

void read_inclusions(const Scene& scene, std::vector<InnerSurface> cavity,
                     BodySource& body) {
  body.material = materials_of(scene);
  for (const SceneInclusion& inclusion : scene.inclusion) {
    body.inner.push_back(inner_surface(inclusion));
    if (inclusion.mesh) {
      body.files.push_back(inclusion.mesh->file);
    }
  }
  std::move(cavity.begin(), cavity.end(), std::back_inserter(body.inner));
  mark_cut(body.surface, body.inner);
  check_left_out(body);
  body.inner = check_inner_surfaces(body.surface, body.inner);
}

// Smallest extent of what a support encloses [m]; of a plane without an end none.
double smallest_extent_m(const SceneSupport& support) {
  if (support.box_m) {
    return support.box_m->sizes().minCoeff();
  }
  return support.patch ? 2.0 * support.patch->radius_m
                       : std::numeric_limits<double>::infinity();
}

// Share of a triangle that a support holds, by points that lie evenly in it; of one
// whose corners it holds, all: rounding may put the points beside a flat side of it.
double held_share(const SceneSupport& support, const SurfaceMesh& surface,
                  Eigen::Index triangle) {
  std::array<Eigen::Vector3d, 3> corner;
  for (int k = 0; k < 3; ++k) {
    corner[static_cast<std::size_t>(k)] =
        surface.position_m.row(surface.triangle(triangle, k)).transpose();
  }
  if (std::all_of(corner.begin(), corner.end(), [&](const Eigen::Vector3d& p_m) {
        return holds(support, p_m);
      })) {
    return 1.0;
  }
  const double longest_m =
      std::max({(corner[1] - corner[0]).norm(), (corner[2] - corner[1]).norm(),
                (corner[0] - corner[2]).norm()});
  constexpr double kFewest = 4.0;
  constexpr double kMost = 64.0;
  const int n = static_cast<int>(std::ceil(
      std::clamp(kFewest * longest_m / smallest_extent_m(support), kFewest, kMost)));
  int inside = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n - i; ++j) {
      // Centroids of the n^2 small triangles: upright ones, and those upside down.
      for (const double third : {1.0 / 3.0, 2.0 / 3.0}) {
        if (third > 0.5 && j == n - i - 1) {
          continue;
        }
        const double a = (i + third) / n;
        const double b = (j + third) / n;
        inside += holds(support, corner[0] + a * (corner[1] - corner[0]) +
                                     b * (corner[2] - corner[0]))
                      ? 1
                      : 0;
      }
    }
  }
  return static_cast<double>(inside) / (n * n);
}

// A vertex alone is enough where a mesh is refined around it.
void require_supports(const Scene& scene, const SurfaceMesh& surface) {
  const std::vector<double> area_m2 = supported_areas_m2(scene, surface);
  for (std::size_t i = 0; i < area_m2.size(); ++i) {
    bool holds_any = area_m2[i] > 0.0;
    for (Eigen::Index v = 0; v < surface.position_m.rows() && !holds_any; ++v) {
      holds_any = holds(scene.support[i], surface.position_m.row(v).transpose());
    }
    if (!holds_any) {
      const Eigen::AlignedBox3d box = bounding_box(surface);
      throw InputError(fmt::format(
          "support {} of {} holds nothing: no point of the body's surface lies in it, "
          "which fills ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g}) m",
          i + 1, area_m2.size(), box.min().x(), box.min().y(), box.min().z(),
          box.max().x(), box.max().y(), box.max().z()));
    }
  }
}

}  // namespace

std::vector<double> supported_areas_m2(const Scene& scene, const SurfaceMesh& surface) {
  std::vector<double> area_m2;
  for (const SceneSupport& support : scene.support) {
    double sum = 0.0;
    for (Eigen::Index t = 0; t < surface.triangle.rows(); ++t) {
      const Eigen::RowVector3d a = surface.position_m.row(surface.triangle(t, 0));
      const Eigen::RowVector3d ab = surface.position_m.row(surface.triangle(t, 1)) - a;
      const Eigen::RowVector3d ac = surface.position_m.row(surface.triangle(t, 2)) - a;
      sum += 0.5 * ab.cross(ac).norm() * held_share(support, surface, t);
    }
    area_m2.push_back(sum);
  }
  return area_m2;
}

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
  HollowBody hollow = read_hollow_body(scene, repair, body.notes);
  body.surface = std::move(hollow.surface);
  body.files.push_back(scene.mesh);
  require_supports(scene, body.surface);
  body.normal = vertex_normals(body.surface);
  body.held = held_points(body.surface, [&](const Eigen::Vector3d& p_m) {
    return is_held(scene, p_m);
  });
  read_inclusions(scene, std::move(hollow.cavity), body);
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
    if (is_reachable(scene, body.surface.position_m.row(v).transpose())) {
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
