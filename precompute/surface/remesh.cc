#include "precompute/surface/remesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <CGAL/Bbox_3.h>
#include <CGAL/Polygon_mesh_processing/detect_features.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/surface/cgal_surface.h"
#include "precompute/surface/disjoint_sets.h"
#include "precompute/surface/repair_intersections.h"
#include "precompute/surface/surface_check.h"
#include "precompute/surface/surface_distance.h"
#include "precompute/surface/surface_in_child.h"

namespace palpate {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;

constexpr double kFeatureDegrees = 60.0;
constexpr double kTrianglesMax = 2e6;
constexpr double kRemeshVolumeChange = 0.1;  // [-]
constexpr unsigned kRemeshSweeps = 5;

using Sharp = CgalMesh::Property_map<CgalMesh::Edge_index, bool>;

// Sharp edges of the surface, but for lines of them that span less than two new
// edges: the slivers of a voxel surface, which would stay.
std::vector<CgalMesh::Edge_index> sharp_edges(CgalMesh& surface, double edge_m,
                                              Sharp& feature) {
  constexpr double kSmallestLine = 2.0;  // [-] of the new edges
  pmp::detect_sharp_edges(surface, kFeatureDegrees, feature);
  const auto end = [&](CgalMesh::Edge_index e, unsigned int i) {
    return static_cast<std::int32_t>(surface.vertex(e, i).idx());
  };
  Partition line(surface.number_of_vertices());
  for (const auto e : surface.edges()) {
    if (feature[e]) {
      line.join(end(e, 0), end(e, 1));
    }
  }
  std::map<std::int32_t, CGAL::Bbox_3> box;  // by line
  for (const auto e : surface.edges()) {
    if (feature[e]) {
      box[line.find(end(e, 0))] += surface.point(surface.vertex(e, 0)).bbox() +
                                   surface.point(surface.vertex(e, 1)).bbox();
    }
  }
  const auto extent_m = [&](CgalMesh::Edge_index e) {
    const CGAL::Bbox_3& of = box[line.find(end(e, 0))];
    return std::hypot(of.x_span(), of.y_span(), of.z_span());
  };
  std::vector<CgalMesh::Edge_index> sharp;
  for (const auto e : surface.edges()) {
    feature[e] = feature[e] && extent_m(e) >= kSmallestLine * edge_m;
    if (feature[e]) {
      sharp.push_back(e);
    }
  }
  return sharp;
}

SurfaceAndCounts remeshed(const SurfaceMesh& mesh, double edge_m) {
  CgalMesh surface = to_cgal(mesh);
  Sharp feature =
      surface.add_property_map<CgalMesh::Edge_index, bool>("e:feature", false).first;
  const std::vector<CgalMesh::Edge_index> sharp = sharp_edges(surface, edge_m, feature);
  const std::size_t features = sharp.size();
  // The remesher must not be given a kept edge that is longer than it may make.
  pmp::split_long_edges(sharp, 4.0 / 3.0 * edge_m, surface,
                        CGAL::parameters::edge_is_constrained_map(feature));
  pmp::isotropic_remeshing(surface.faces(), edge_m, surface,
                           CGAL::parameters::number_of_iterations(kRemeshSweeps)
                               .edge_is_constrained_map(feature)
                               .protect_constraints(true));
  // Sweeps may tangle what they smooth.
  return {.mesh = repair_intersections(from_cgal(std::move(surface))),
          .count = {features}};
}

void check_wish(const SurfaceReport& report, double edge_m) {
  if (!report.accepted()) {
    throw InputError(fmt::format("remesh: {}", report.verdict()));
  }
  if (report.specks() > 0) {
    throw InputError(fmt::format(
        "remesh: {} of the surface's {} parts are specks, too small for new edges: "
        "palpate-precompute check MESH --repair=safe -o OUT leaves them out",
        report.specks(), report.components));
  }
  if (!(edge_m > 0.0) || !std::isfinite(edge_m)) {
    throw InputError(fmt::format("remesh: the edge is {} m, must be above 0", edge_m));
  }
  const double triangles = report.area_m2 / (0.25 * std::sqrt(3.0) * edge_m * edge_m);
  if (!(triangles <= kTrianglesMax)) {
    throw InputError(fmt::format(
        "remesh: edges of {} m make about {:.3g} triangles, at most {:.3g} are allowed",
        edge_m, triangles, kTrianglesMax));
  }
}

void check_result(const SurfaceReport& before, const SurfaceReport& after,
                  double edge_m) {
  const double change = after.volume_m3 / before.volume_m3 - 1.0;
  if (!after.accepted()) {
    throw InputError(
        fmt::format("remesh: edges of {} m spoil the surface, try shorter ones: {}",
                    edge_m, after.verdict()));
  }
  if (after.components != before.components ||
      !(std::abs(change) <= kRemeshVolumeChange)) {
    throw InputError(fmt::format(
        "remesh: edges of {} m are too long for the body: {} of {} parts are left, the "
        "volume changes by {:.3g} %",
        edge_m, after.components, before.components, 100.0 * change));
  }
}

}  // namespace

RemeshedSurface remesh_surface(const SurfaceMesh& mesh, double edge_m) {
  const CheckedSurface before = check_surface(mesh);
  check_wish(before.report, edge_m);
  const SurfaceAndCounts made =
      surface_in_child("remesh", remeshed, before.mesh, edge_m);
  CheckedSurface after = check_surface(made.mesh);
  check_result(before.report, after.report, edge_m);
  RemeshReport report{
      .edge_mean_before_m = before.report.edge_mean_m,
      .edge_mean_m = after.report.edge_mean_m,
      .smallest_angle_before_rad = before.report.smallest_angle_rad,
      .smallest_angle_rad = after.report.smallest_angle_rad,
      .displaced_m = std::max(distance_to_surface_m(before.mesh, after.mesh),
                              distance_to_surface_m(after.mesh, before.mesh)),
      .volume_relative = after.report.volume_m3 / before.report.volume_m3 - 1.0,
      .features = made.count.at(0)};
  return {.mesh = std::move(after.mesh), .report = report};
}

}  // namespace palpate
