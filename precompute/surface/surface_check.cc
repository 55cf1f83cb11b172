#include "precompute/surface/surface_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/mesh/angle_between.h"
#include "precompute/surface/disjoint_sets.h"
#include "precompute/surface/self_intersections.h"
#include "precompute/surface/signed_distance.h"
#include "precompute/surface/winding_number.h"

namespace palpate {
namespace {

using Edge = std::pair<std::int32_t, std::int32_t>;

Eigen::Vector3d vertex_m(const SurfaceMesh& mesh, std::int32_t v) {
  return mesh.position_m.row(v).transpose();
}

Eigen::Vector3d corner_m(const SurfaceMesh& mesh, Eigen::Index t, int j) {
  return vertex_m(mesh, mesh.triangle(t, j % 3));
}

// How often an edge is run through upwards and downwards in vertex numbers.
struct EdgeUse {
  int up = 0;
  int down = 0;
};

void find_edge_defects(const SurfaceMesh& mesh, SurfaceReport& report) {
  std::map<Edge, EdgeUse> edges;
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    for (int j = 0; j < 3; ++j) {
      const std::int32_t from = mesh.triangle(t, j);
      const std::int32_t to = mesh.triangle(t, (j + 1) % 3);
      EdgeUse& use = edges[std::minmax(from, to)];
      ++(from < to ? use.up : use.down);
    }
  }
  for (const auto& [edge, use] : edges) {
    const Eigen::Vector3d at_m =
        0.5 * (vertex_m(mesh, edge.first) + vertex_m(mesh, edge.second));
    if (use.up + use.down == 1) {
      report.border_edges.add(at_m);
    } else if (use.up + use.down > 2) {
      report.non_manifold_edges.add(at_m);
    } else if (use.up != use.down) {
      report.flipped_edges.add(at_m);
    }
  }
}

// Corners on one line: the height over the longest edge is lost in rounding.
bool degenerate(const SurfaceMesh& mesh, Eigen::Index t) {
  const Eigen::Vector3d a = corner_m(mesh, t, 1) - corner_m(mesh, t, 0);
  const Eigen::Vector3d b = corner_m(mesh, t, 2) - corner_m(mesh, t, 0);
  const double longest2 =
      std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
  return !(a.cross(b).norm() > 1e-10 * longest2);
}

void find_triangle_defects(const SurfaceMesh& mesh, SurfaceReport& report) {
  report.smallest_angle_rad = std::numbers::pi / 3.0;
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    report.smallest_angle_rad =
        std::min(report.smallest_angle_rad, smallest_angle_rad(mesh, t));
    if (degenerate(mesh, t)) {
      report.degenerate_triangles.add(triangle_middle_m(mesh, t));
    }
  }
  for (const auto& [a, b] : self_intersections(mesh)) {
    report.self_intersections.add(
        0.5 * (triangle_middle_m(mesh, a) + triangle_middle_m(mesh, b)));
  }
}

// A vertex is manifold if its triangles form one fan: joined by edges at the vertex,
// they are one set. Keyed by (vertex, triangle corner) through corner numbers 3t + j.
void find_vertex_defects(const SurfaceMesh& mesh, SurfaceReport& report) {
  const Eigen::Index corners = 3 * mesh.triangle.rows();
  Partition fan(static_cast<std::size_t>(corners));
  std::map<Edge, std::array<std::int32_t, 2>> first_corner;  // of (from, to) ascending
  for (std::int32_t t = 0; t < mesh.triangle.rows(); ++t) {
    for (int j = 0; j < 3; ++j) {
      std::int32_t from = 3 * t + j;
      std::int32_t to = 3 * t + (j + 1) % 3;
      if (mesh.triangle(t, j) > mesh.triangle(t, (j + 1) % 3)) {
        std::swap(from, to);
      }
      const auto edge = std::minmax(mesh.triangle(t, j), mesh.triangle(t, (j + 1) % 3));
      const auto [at, inserted] =
          first_corner.try_emplace(edge, std::array<std::int32_t, 2>{from, to});
      if (!inserted) {
        fan.join(from, at->second[0]);
        fan.join(to, at->second[1]);
      }
    }
  }
  std::vector<std::int32_t> fans(static_cast<std::size_t>(mesh.position_m.rows()), 0);
  for (std::int32_t c = 0; c < corners; ++c) {
    if (fan.find(c) == c) {
      ++fans[static_cast<std::size_t>(mesh.triangle(c / 3, c % 3))];
    }
  }
  for (std::int32_t v = 0; v < mesh.position_m.rows(); ++v) {
    const std::int32_t count = fans[static_cast<std::size_t>(v)];
    if (count == 0) {
      report.isolated_vertices.add(vertex_m(mesh, v));
    } else if (count > 1) {
      report.non_manifold_vertices.add(vertex_m(mesh, v));
    }
  }
}

void find_duplicates(const SurfaceMesh& mesh, SurfaceReport& report) {
  std::map<std::array<double, 3>, std::int32_t> seen;
  for (std::int32_t v = 0; v < mesh.position_m.rows(); ++v) {
    const Eigen::Vector3d at_m = vertex_m(mesh, v);
    // -0.0 == 0.0 here, as it is for the mesher.
    if (!seen.try_emplace({at_m.x(), at_m.y(), at_m.z()}, v).second) {
      report.duplicate_vertices.add(at_m);
    }
  }
}

void turn(SurfaceMesh& mesh, const SurfacePart& part) {
  for (const Eigen::Index t : part.triangle) {
    std::swap(mesh.triangle(t, 1), mesh.triangle(t, 2));
  }
}

// Whether points lie inside one part. A tree answers many questions about a large part;
// it needs normals, which triangles without area have not.
class Inside {
 public:
  Inside(const SurfaceMesh& mesh, const SurfacePart& part, bool many)
      : alone_(of_triangles(mesh, part.triangle)),
        box_m_(bounding_box(alone_)),
        outward_(part.volume_m3 < 0.0 ? -1.0 : 1.0),
        many_(many) {}

  [[nodiscard]] bool holds(const Eigen::Vector3d& p_m) {
    if (!box_m_.contains(p_m)) {
      return false;
    }
    if (!many_) {
      return std::abs(winding_number(alone_, p_m)) > 0.5;
    }
    if (!distance_) {
      distance_ = std::make_unique<SignedDistance>(alone_);
    }
    return outward_ * distance_->at_m(p_m).distance_m < 0.0;
  }

 private:
  SurfaceMesh alone_;
  Eigen::AlignedBox3d box_m_;
  double outward_;
  bool many_;
  std::unique_ptr<SignedDistance> distance_;
};

// How many of the other parts each part lies in, and the outermost of them, or itself.
std::vector<std::size_t> find_nesting(const SurfaceMesh& mesh, SurfaceReport& report) {
  constexpr std::size_t kMany = 16;
  std::vector<SurfacePart>& parts = report.part;
  const bool many = parts.size() > kMany && report.degenerate_triangles.count == 0;
  // Parts do not cross: one corner says whether the whole part lies inside.
  std::vector<std::vector<std::size_t>> around(parts.size());
  for (std::size_t outer = 0; outer < parts.size() && parts.size() > 1; ++outer) {
    Inside inside(mesh, parts[outer], many);
    for (std::size_t inner = 0; inner < parts.size(); ++inner) {
      if (inner != outer &&
          inside.holds(corner_m(mesh, parts[inner].triangle.front(), 0))) {
        around[inner].push_back(outer);
        ++parts[inner].around;
      }
    }
  }
  std::vector<std::size_t> outermost;
  for (std::size_t inner = 0; inner < parts.size(); ++inner) {
    // The outermost part around is the one that lies in no other.
    const auto at = std::find_if(around[inner].begin(), around[inner].end(),
                                 [&](std::size_t outer) {
                                   return around[outer].empty();
                                 });
    outermost.push_back(at == around[inner].end() ? inner : *at);
  }
  return outermost;
}

// Parts by themselves: which way they face, whether one lies inside another.
void check_parts(SurfaceMesh& mesh, SurfaceReport& report) {
  report.part = surface_parts(mesh);
  std::vector<SurfacePart>& parts = report.part;
  report.components = std::ssize(parts);
  if (!report.closed() || report.flipped_edges.count > 0 ||
      report.non_manifold_edges.count > 0) {
    return;  // no inside to speak of
  }
  for (const SurfacePart& part : parts) {
    const double extent_m = bounding_box(part_mesh(mesh, part)).sizes().maxCoeff();
    report.flat |= !(std::abs(part.volume_m3) > 1e-12 * extent_m * extent_m * extent_m);
  }
  // Parts that cross are reported as that.
  const bool crossing = report.self_intersections.count > 0;
  const std::vector<std::size_t> outermost =
      crossing ? std::vector<std::size_t>{} : find_nesting(mesh, report);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const bool inside_out = parts[i].volume_m3 < 0.0;
    if (parts[i].is_cavity() && inside_out == (parts[outermost[i]].volume_m3 < 0.0)) {
      report.nested_components.add(corner_m(mesh, parts[i].triangle.front(), 0));
    }
    if (inside_out != parts[i].is_cavity()) {
      turn(mesh, parts[i]);
      ++report.components_turned;
    }
  }
}

std::string described(const SurfaceDefect& defect, const char* one, const char* many) {
  if (defect.count == 0) {
    return {};
  }
  std::string places;
  for (const Eigen::Vector3d& p : defect.where_m) {
    places += (places.empty() ? "" : ", ") + place_text(p);
  }
  return fmt::format("{} {} at {}{} m", defect.count, defect.count == 1 ? one : many,
                     places, defect.count > defect.where_m.size() ? ", ..." : "");
}

std::string accepted_verdict(const SurfaceReport& report) {
  std::string text =
      fmt::format("a closed body of {:.4g} m^3, {} vertices, {} triangles",
                  report.volume_m3, report.vertices, report.triangles);
  if (const Eigen::Index solid = report.components - report.cavities(); solid > 1) {
    text += fmt::format(", in {} disjoint parts", solid);
  }
  if (report.cavities() > 0) {
    text += fmt::format(", with {} {}", report.cavities(),
                        report.cavities() == 1 ? "cavity" : "cavities");
  }
  if (report.specks() > 0) {
    text += fmt::format(
        ", {} of them below {} % of the volume: --repair=safe leaves specks out",
        report.specks(), 100.0 * kSpeckShare);
  }
  if (report.components_turned > 0) {
    text += fmt::format("; {} inside out, turned",
                        report.components > 1
                            ? fmt::format("{} parts were", report.components_turned)
                            : "it was");
  }
  return text;
}

}  // namespace

std::string place_text(const Eigen::Vector3d& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z());
}

Eigen::Vector3d triangle_middle_m(const SurfaceMesh& mesh, Eigen::Index t) {
  return (corner_m(mesh, t, 0) + corner_m(mesh, t, 1) + corner_m(mesh, t, 2)) / 3.0;
}

double smallest_angle_rad(const SurfaceMesh& mesh, Eigen::Index t) {
  double smallest = std::numbers::pi;
  for (int j = 0; j < 3; ++j) {
    const Eigen::Vector3d a = corner_m(mesh, t, j + 1) - corner_m(mesh, t, j);
    const Eigen::Vector3d b = corner_m(mesh, t, j + 2) - corner_m(mesh, t, j);
    smallest = std::min(smallest, angle_between(a, b));
  }
  return smallest;
}

void SurfaceDefect::add(const Eigen::Vector3d& at_m) {
  ++count;
  if (where_m.size() < kDefectsShown) {
    where_m.push_back(at_m);
  }
}

const std::array<DefectKind, 9>& defect_kinds() {
  using R = SurfaceReport;
  static constexpr std::array<DefectKind, 9> kKinds{{
      {&R::border_edges, "border_edges", "border edge (the surface is open)",
       "border edges (the surface is open)"},
      {&R::non_manifold_edges, "non_manifold_edges", "edge of more than two triangles",
       "edges of more than two triangles"},
      {&R::flipped_edges, "flipped_edges", "edge whose triangles face opposite ways",
       "edges whose triangles face opposite ways"},
      {&R::non_manifold_vertices, "non_manifold_vertices",
       "vertex where separate sheets touch", "vertices where separate sheets touch"},
      {&R::duplicate_vertices, "duplicate_vertices", "duplicate vertex",
       "duplicate vertices"},
      {&R::isolated_vertices, "isolated_vertices", "vertex of no triangle",
       "vertices of no triangle"},
      {&R::degenerate_triangles, "degenerate_triangles", "degenerate triangle",
       "degenerate triangles"},
      {&R::self_intersections, "self_intersections",
       "self-intersecting pair of triangles", "self-intersecting pairs of triangles"},
      {&R::nested_components, "nested_components",
       "part inside another part that faces as it does (a cavity after --repair=safe; "
       "an [[inclusion]] of a scene by a mesh of its own)",
       "parts inside another part that face as it does (cavities after --repair=safe; "
       "each an [[inclusion]] of a scene by a mesh of its own)"},
  }};
  return kKinds;
}

bool SurfaceReport::in_a_plane() const {
  return triangles > 0 && !(extent_m.minCoeff() > 1e-9 * extent_m.maxCoeff());
}

Eigen::Index SurfaceReport::specks() const {
  return std::count_if(part.begin(), part.end(), [](const SurfacePart& one) {
    return one.speck;
  });
}

Eigen::Index SurfaceReport::cavities() const {
  return std::count_if(part.begin(), part.end(), [](const SurfacePart& one) {
    return one.is_cavity();
  });
}

bool SurfaceReport::accepted() const {
  return !flat && triangles > 0 &&
         std::all_of(defect_kinds().begin(), defect_kinds().end(),
                     [&](const DefectKind& kind) {
                       return (this->*kind.defect).count == 0;
                     });
}

std::string SurfaceReport::verdict() const {
  if (accepted()) {
    return accepted_verdict(*this);
  }
  std::string text;
  const auto add = [&](const std::string& more) {
    text += (text.empty() || more.empty() ? "" : "; ") + more;
  };
  for (const DefectKind& kind : defect_kinds()) {
    add(described(this->*kind.defect, kind.one, kind.many));
  }
  add(triangles == 0 ? "no triangles" : "");
  add(flat ? "it encloses no volume" : "");
  add(in_a_plane()
          ? "all of it lies in one plane, where a body has a volume: give the "
            "sheet its thickness in the program that made it (extrude, solidify)"
          : "");
  return "not a body: " + text;
}

CheckedSurface check_surface(SurfaceMesh mesh) {
  SurfaceReport report;
  report.vertices = mesh.position_m.rows();
  report.triangles = mesh.triangle.rows();
  find_edge_defects(mesh, report);
  find_triangle_defects(mesh, report);
  find_vertex_defects(mesh, report);
  find_duplicates(mesh, report);
  check_parts(mesh, report);
  report.area_m2 = surface_area_m2(mesh);
  report.volume_m3 = enclosed_volume_m3(mesh);
  report.edge_mean_m = mean_edge_m(mesh);
  if (report.vertices > 0) {
    report.lowest_m = bounding_box(mesh).min();
    report.extent_m = bounding_box(mesh).sizes();
  }
  return {.mesh = std::move(mesh), .report = std::move(report)};
}

CheckedSurface require_body(SurfaceMesh mesh, std::string_view name) {
  CheckedSurface checked = check_surface(std::move(mesh));
  if (!checked.report.accepted()) {
    throw InputError(fmt::format("{}: {}", name, checked.report.verdict()));
  }
  return checked;
}

}  // namespace palpate
