#include "precompute/surface/repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "precompute/surface/glued_parts.h"
#include "precompute/surface/repair_intersections.h"
#include "precompute/surface/repair_topology.h"
#include "precompute/surface/self_intersections.h"
#include "precompute/surface/surface_distance.h"
#include "precompute/surface/surface_in_child.h"
#include "precompute/surface/surface_soup.h"
#include "precompute/surface/t_junctions.h"
#include "precompute/surface/winding_number.h"
#include "precompute/surface/wrap_surface.h"

namespace palpate {
namespace {

constexpr double kHoleMax = 0.1;        // [-] of the diagonal, as the next ones
constexpr double kDisplacedMax = 0.01;  // beyond: not the same body any more
constexpr double kVolumeChange = 0.05;  // [-] of a closed surface's volume
constexpr double kAreaChange = 0.1;     // [-] of an open surface's area
constexpr double kWrapOpening = 0.01;
constexpr double kWrapOffset = 0.0005;
constexpr double kLostMax = 0.1;  // [-] of what is enclosed, by a wrap

// What each of the counts that the child sends back stands for.
constexpr std::size_t kFilledHoles = 11;
constexpr std::array<const char*, 14> kRepairSteps{
    "duplicate vertices welded",
    "collapsed triangles taken out",
    "duplicate triangles taken out",
    "vertices of no triangle taken out",
    "faces or walls inside the body taken out: its parts are one there",
    "specks taken out: parts below 0.1 % of the body",
    "vertices put on edges of neighbours that they lie on",
    "triangles turned to agree with their neighbours",
    "vertices added to part sheets that touched",
    "pairs of coinciding border edges joined",
    "degenerate triangles taken out",
    "holes filled",
    "self-intersecting pairs of triangles replaced",
    "parts inside another turned: each is a cavity",
};

double diagonal_m(const SurfaceMesh& mesh) {
  return bounding_box(mesh).diagonal().norm();
}

SurfaceMesh without_intersections(const SurfaceMesh& mesh, std::size_t& replaced) {
  SurfaceMesh result = repair_intersections(mesh);
  replaced = self_intersections(mesh).size() - self_intersections(result).size();
  return result;
}

// What is there, once, but for specks and walls inside, and parted where it touches.
struct Cleaned {
  SurfaceMesh mesh;
  SoupChanges soup;
  std::size_t walls = 0;
  std::size_t specks = 0;
  std::size_t parted = 0;  // new vertices
  SurfaceMesh touching;    // the same triangles before that
};

Cleaned cleaned(const SurfaceMesh& mesh) {
  Cleaned result;
  result.mesh = clean_soup(mesh, result.soup);
  result.walls = result.soup.shared_faces;
  result.touching = without_inner_walls(result.mesh, result.walls);
  result.mesh = part_touching(result.touching, result.parted);
  std::vector<Eigen::Index> kept;
  for (const SurfacePart& part : surface_parts(result.mesh)) {
    result.specks += part.speck ? 1U : 0U;
    if (!part.speck) {
      kept.insert(kept.end(), part.triangle.begin(), part.triangle.end());
    }
  }
  if (result.specks > 0) {
    result.mesh = of_triangles(result.mesh, kept);
    result.touching = of_triangles(result.touching, std::move(kept));
  }
  return result;
}

SurfaceAndCounts safe_repair(const SurfaceMesh& mesh, double /*parameter*/) {
  TopologyChanges topology;
  const auto [clean, soup, walls, specks, parted, touching] = cleaned(mesh);
  std::size_t junctions = 0;
  SurfaceMesh result = repair_topology(cut_at_t_junctions(clean, junctions),
                                       kHoleMax * diagonal_m(mesh), topology);
  std::size_t replaced = 0;
  if (check_surface(result).report.closed()) {
    result = without_intersections(result, replaced);
  }
  CheckedSurface checked = check_surface(std::move(result));
  return {.mesh = in_original_order(checked.mesh, mesh),
          .count = {soup.welded_vertices, soup.collapsed_triangles,
                    soup.duplicate_triangles, soup.isolated_vertices, walls, specks,
                    junctions, topology.turned_triangles,
                    parted + topology.split_vertices, topology.stitched_borders,
                    topology.degenerate_triangles, topology.filled_holes, replaced,
                    checked.report.nested_components.count}};
}

// Holes are closed first: a wrap would go in through them and line the inside.
SurfaceAndCounts wrap_repair(const SurfaceMesh& mesh, double /*parameter*/) {
  const double size_m = diagonal_m(mesh);
  SoupChanges soup;
  TopologyChanges topology;
  const SurfaceMesh closed = close_holes(clean_soup(mesh, soup), topology);
  SurfaceAndCounts result{
      .mesh = wrap_surface(closed, kWrapOpening * size_m, kWrapOffset * size_m),
      .count = {}};
  result.count.resize(kRepairSteps.size());
  result.count[kFilledHoles] = topology.filled_holes;
  result.lost_share = share_outside(closed, result.mesh);
  return result;
}

// Why a safe repair is not to be trusted; empty if it is.
// @param clean a file may list each triangle alone, or twice: what is there once.
std::string doubts(const SurfaceMesh& clean, const RepairReport& report) {
  const SurfaceReport& before = report.before;
  const SurfaceReport& after = report.after;
  const Eigen::Index parts_before = std::ssize(surface_parts(clean));
  const double area_m2 = surface_area_m2(clean);
  if (after.components != parts_before) {
    return fmt::format("{} parts became {}", parts_before, after.components);
  }
  const double displaced_max_m = kDisplacedMax * diagonal_m(clean);
  if (!(report.displaced_m <= displaced_max_m)) {
    return fmt::format("the surface moved by {:.3g} m, at most {:.3g} m is safe",
                       report.displaced_m, displaced_max_m);
  }
  if (before.has_volume()) {
    if (!(std::abs(report.volume_relative) <= kVolumeChange)) {
      return fmt::format("the volume changed from {:.4g} to {:.4g} m^3",
                         before.volume_m3, after.volume_m3);
    }
  } else if (!(std::abs(after.area_m2 - area_m2) <= kAreaChange * area_m2)) {
    return fmt::format("the area changed from {:.4g} to {:.4g} m^2", area_m2,
                       after.area_m2);
  }
  return {};
}

std::string lost(double share) {
  return fmt::format(
      "the wrap is hollow: it leaves out {:.0f} % of what the surface encloses: "
      "openings are too wide to tell inside from outside",
      100.0 * share);
}

void describe_repair(const SurfaceMesh& mesh, RepairMode mode,
                     const SurfaceAndCounts& made, RepairedSurface& result) {
  const std::vector<std::size_t>& count = made.count;
  RepairReport& report = result.report;
  for (std::size_t i = 0; i < count.size(); ++i) {
    if (count[i] > 0) {
      report.changed.push_back({.what = kRepairSteps[i], .count = count[i]});
    }
  }
  if (mode == RepairMode::kWrap) {
    report.changed.push_back({.what = "triangles wrapped by a new surface",
                              .count = static_cast<std::size_t>(mesh.triangle.rows())});
  }
  CheckedSurface checked = check_surface(std::move(result.mesh));
  result.mesh = std::move(checked.mesh);
  report.after = std::move(checked.report);
  report.original_vertex = original_vertices(result.mesh, mesh);
  report.volume_relative = report.before.has_volume()
                               ? report.after.volume_m3 / report.before.volume_m3 - 1.0
                               : std::numeric_limits<double>::quiet_NaN();
  if (!report.after.accepted()) {
    report.refusal = report.after.verdict();
    return;
  }
  // What was left out on purpose was not displaced.
  const Cleaned clean = mode == RepairMode::kSafe
                            ? cleaned(mesh)
                            : Cleaned{.mesh = {}, .soup = {}, .touching = mesh};
  report.displaced_m = distance_to_surface_m(clean.touching, result.mesh);
  if (report.before.closed()) {  // else a filled hole would count
    report.displaced_m = std::max(report.displaced_m,
                                  distance_to_surface_m(result.mesh, clean.touching));
  }
  if (mode == RepairMode::kSafe) {
    report.refusal = doubts(clean.mesh, report);
  } else if (made.lost_share > kLostMax) {
    report.refusal = lost(made.lost_share);
  }
}

const char* mode_name(RepairMode mode) {
  switch (mode) {
    case RepairMode::kOff:
      return "off";
    case RepairMode::kSafe:
      return "safe";
    case RepairMode::kWrap:
      break;
  }
  return "wrap";
}

}  // namespace

RepairMode repair_mode(std::string_view name) {
  for (const RepairMode mode :
       {RepairMode::kOff, RepairMode::kSafe, RepairMode::kWrap}) {
    if (name == mode_name(mode)) {
      return mode;
    }
  }
  throw InputError(fmt::format("repair = {:?}, must be off, safe or wrap", name));
}

RepairedSurface repair_surface(const SurfaceMesh& mesh, RepairMode mode) {
  if (mesh.triangle.rows() == 0) {
    throw InputError("repair: the surface has no triangles");
  }
  CheckedSurface checked = check_surface(mesh);
  RepairedSurface result;
  result.report.before = checked.report;
  const bool specks = mode == RepairMode::kSafe && checked.report.specks() > 0;
  if (mode == RepairMode::kOff || checked.report.in_a_plane() ||
      (checked.report.accepted() && !specks)) {
    result.mesh = std::move(checked.mesh);
    result.report.after = checked.report;
    result.report.original_vertex = original_vertices(result.mesh, mesh);
    result.report.refusal = checked.report.accepted() ? "" : checked.report.verdict();
    return result;
  }
  SurfaceAndCounts made = surface_in_child(
      fmt::format("repair \"{}\"", mode_name(mode)),
      mode == RepairMode::kSafe ? safe_repair : wrap_repair, mesh, 0.0);
  result.mesh = std::move(made.mesh);
  describe_repair(mesh, mode, made, result);
  return result;
}

RepairMode working_repair(const SurfaceMesh& mesh, RepairMode tried) {
  for (const RepairMode mode : {RepairMode::kSafe, RepairMode::kWrap}) {
    if (mode > tried) {
      try {
        if (repair_surface(mesh, mode).report.refusal.empty()) {
          return mode;
        }
      } catch (const NumericalError&) {
        // It does not work.
      }
    }
  }
  return RepairMode::kOff;
}

std::string repair_advice(RepairMode mode) {
  return mode == RepairMode::kOff
             ? "no repair makes a body of it: mend it by hand"
             : fmt::format("--repair={} makes a body of it", mode_name(mode));
}

CheckedSurface require_body(const SurfaceMesh& mesh, RepairMode mode,
                            std::string_view name, std::vector<std::string>& notes) {
  RepairedSurface repaired = repair_surface(mesh, mode);
  RepairReport& report = repaired.report;
  if (!report.refusal.empty()) {
    const std::string what =
        mode == RepairMode::kOff
            ? report.refusal
            : fmt::format("repair \"{}\" failed: {}", mode_name(mode), report.refusal);
    throw InputError(fmt::format("{}: {}; {}", name, what,
                                 repair_advice(working_repair(mesh, mode))));
  }
  for (const RepairStep& step : report.changed) {
    notes.push_back(fmt::format("{}: repair: {} {}", name, step.count, step.what));
  }
  if (mode == RepairMode::kWrap && !report.changed.empty()) {
    notes.push_back(fmt::format(
        "{}: THE SURFACE IS NEW: wrapped, none of its vertices is the file's; {}moved "
        "by up to {:.3g} m",
        name,
        std::isfinite(report.volume_relative)
            ? fmt::format("volume {:+.2f} %, ", 100.0 * report.volume_relative)
            : std::string(),
        report.displaced_m));
  }
  return {.mesh = std::move(repaired.mesh), .report = std::move(report.after)};
}

}  // namespace palpate
