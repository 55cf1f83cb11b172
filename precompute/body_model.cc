#include "precompute/body_model.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "formats/error.h"
#include "precompute/subdivide.h"
#include "precompute/surface_check.h"
#include "precompute/surface_reader.h"
#include "precompute/tetrahedralise.h"
#include "precompute/tool_surface.h"

namespace palpate {
namespace {

// Past this many surface triangles a body of compact shape has some 200 000 quadratic
// nodes, and its factor outgrows the memory of a small machine.
constexpr Eigen::Index kMostTriangles = 30000;

// What scenes can say and this build cannot do yet.
void refuse_what_is_missing(const Scene& scene) {
  const auto refuse = [](bool asked, const std::string& what) {
    if (asked) {
      throw InputError(what + " is not available in precompute yet");
    }
  };
  for (const SceneInclusion& inclusion : scene.inclusion) {
    refuse(true, fmt::format("inclusion {:?}: a body of several regions or with a hole",
                             inclusion.name));
  }
  for (const SceneMaterial& material : scene.material) {
    refuse(material.law != "linear", fmt::format("law {:?} of region {:?} (of: linear)",
                                                 material.law, material.region));
  }
  for (const SceneSupport& support : scene.support) {
    refuse(!support.is_fixed(), "a support of kind \"foundation\" (of: fixed)");
    refuse(!support.box_m, "a support by plane or patch (of: box_m)");
  }
  for (const ToolShape& tool : scene.tool) {
    refuse(tool.kind == "mesh", fmt::format("tool {:?}: shape \"mesh\"", tool.name));
    refuse(tool.sticking, fmt::format("tool {:?}: contact \"sticking\"", tool.name));
  }
  refuse(scene.accuracy.method == "nonlinear", "method \"nonlinear\" in [accuracy]");
  refuse(scene.accuracy.refine == "local", "refine \"local\" in [accuracy]");
  refuse(scene.drawing.displacement, "displacement in [drawing]");
}

SurfaceMesh read_body(const Scene& scene, std::vector<std::string>& notes) {
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
    const double width = ToolSurface(tool).extent_m();
    if (width > extent) {
      throw InputError(
          fmt::format("tool \"{}\" is larger than the body: diameter {} m, the body's "
                      "extent is {} m; "
                      "is length_unit = \"{}\" right?",
                      tool.name, width, extent, scene.length_unit));
    }
  }
  if (scene.reach.depth_max_m > extent) {
    throw InputError(
        fmt::format("reach.depth_max_m = {} m is more than the body's extent of {} m; "
                    "is length_unit = "
                    "\"{}\" right?",
                    scene.reach.depth_max_m, extent, scene.length_unit));
  }
}

// Contact radius at the largest depth, of the tool that touches least.
double contact_radius_m(const Scene& scene) {
  double radius = std::numeric_limits<double>::infinity();
  for (const ToolShape& tool : scene.tool) {
    radius = std::min(radius, expected_contact_radius_m(tool, scene.reach.depth_max_m));
  }
  return radius;
}

// Cuts the surface until the contact spans the nodes that the scene asks for. Contact
// nodes sit on corners and edge middles: their distance is half an edge.
SurfaceMesh refine(const Scene& scene, const SurfaceMesh& surface, BodyModel& body) {
  SurfaceMesh fine = surface;
  const double resolution =
      scene.contact_resolution > 0.0 ? scene.contact_resolution : 2.0;
  const double wanted_m = contact_radius_m(scene) / resolution;
  while (0.5 * mean_edge_m(fine) > wanted_m) {
    if (4 * fine.triangle.rows() > kMostTriangles) {
      body.notes.push_back(fmt::format(
          "contact nodes are {:.3g} mm apart where contact_resolution = {} "
          "asks for {:.3g} "
          "mm: a finer surface would pass {} triangles",
          500.0 * mean_edge_m(fine), resolution, 1e3 * wanted_m, kMostTriangles));
      break;
    }
    fine = subdivide_midpoint(fine);
    ++body.subdivisions;
  }
  body.node_spacing_m = 0.5 * mean_edge_m(fine);
  return fine;
}

Material body_material(const Scene& scene) {
  const auto at = std::find_if(scene.material.begin(), scene.material.end(),
                               [](const SceneMaterial& m) {
                                 return m.region == "body";
                               });
  if (at == scene.material.end()) {
    throw InputError("the scene has no [[material]] with region = \"body\"");
  }
  return linear(at->youngs_modulus_pa, at->poissons_ratio);
}

std::vector<Eigen::AlignedBox3d> support_boxes(const Scene& scene) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const SceneSupport& support : scene.support) {
    boxes.push_back(support.box_m.value());
  }
  return boxes;
}

void check_held(const BodyModel& body, const SurfaceMesh& surface) {
  const auto held = static_cast<Eigen::Index>(body.supports.free_index.size()) -
                    static_cast<Eigen::Index>(body.supports.free);
  if (held < 9) {
    const Eigen::AlignedBox3d box = bounding_box(surface);
    throw InputError(fmt::format(
        "the supports hold {} surface nodes, at least 3 that are not in a line are "
        "needed; "
        "the body fills ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g}) m",
        held / 3, box.min().x(), box.min().y(), box.min().z(), box.max().x(),
        box.max().y(), box.max().z()));
  }
}

}  // namespace

BodyModel make_body_model(const Scene& scene, Progress& progress) {
  refuse_what_is_missing(scene);
  BodyModel body;
  progress.stage("surface");
  body.surface = read_body(scene, body.notes);
  check_size(scene, body.surface);
  body.normal = vertex_normals(body.surface);
  const SurfaceMesh fine = refine(scene, body.surface, body);
  progress.stage("tetrahedra");
  const TetMesh tets = tetrahedralise(fine);
  body.min_dihedral_deg =
      tet_quality(tets).smallest_dihedral_rad * 180.0 / std::numbers::pi;
  body.mesh = make_quadratic(tets, fine.triangle);
  progress.stage("stiffness");
  const std::vector<Eigen::AlignedBox3d> boxes = support_boxes(scene);
  body.supports = hold_boxes(body.mesh, boxes);
  check_held(body, body.surface);
  body.material = {body_material(scene)};
  const Stiffness K =
      reduce(assemble_stiffness(body.mesh, body.material), body.supports);
  body.contact = make_contact_surface(body.mesh);
  progress.stage("factorisation");
  body.factor.emplace(K);
  return body;
}

std::vector<std::int32_t> reachable_vertices(const Scene& scene,
                                             const BodyModel& body) {
  std::vector<std::int32_t> vertices;
  for (Eigen::Index v = 0; v < body.surface.position_m.rows(); ++v) {
    const Eigen::Vector3d p = body.surface.position_m.row(v).transpose();
    const bool held = body.supports.free_index[static_cast<std::size_t>(3 * v)] < 0;
    const bool in_reach = !scene.reach.box_m || scene.reach.box_m->contains(p);
    if (!held && in_reach) {
      vertices.push_back(static_cast<std::int32_t>(v));
    }
  }
  if (vertices.empty()) {
    throw InputError(
        "no vertex of the body is both in reach and free: reach.box_m misses the body, "
        "or "
        "the supports hold all of it");
  }
  return vertices;
}

}  // namespace palpate
