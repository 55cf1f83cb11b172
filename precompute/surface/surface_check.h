// Whether a surface bounds a body, and if not: what is wrong, how often and where.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"
#include "precompute/surface/surface_parts.h"

namespace palpate {

/// One kind of defect of a surface.
struct SurfaceDefect {
  std::size_t count = 0;
  std::vector<Eigen::Vector3d> where_m;  ///< [m] the first few, at most kDefectsShown
  void add(const Eigen::Vector3d& at_m);
};

inline constexpr std::size_t kDefectsShown = 3;

struct SurfaceReport {
  Eigen::Index vertices = 0;
  Eigen::Index triangles = 0;
  Eigen::Index components = 0;    ///< parts that share no vertex
  std::vector<SurfacePart> part;  ///< as many
  double area_m2 = 0.0;
  double volume_m3 = 0.0;  ///< after turning; only meaningful if has_volume()
  Eigen::Vector3d lowest_m = Eigen::Vector3d::Zero();  ///< corner of the bounding box
  Eigen::Vector3d extent_m = Eigen::Vector3d::Zero();  ///< its sides
  double edge_mean_m = 0.0;                            ///< mean edge length
  double smallest_angle_rad = 0.0;                     ///< of any triangle's corners
  Eigen::Index components_turned = 0;                  ///< parts that were inside out

  // Any of these refuses the body. A place is the middle of the edge or triangle.
  SurfaceDefect border_edges;           ///< edges of one triangle: the surface is open
  SurfaceDefect flipped_edges;          ///< two triangles that disagree on the outside
  SurfaceDefect non_manifold_edges;     ///< edges of more than two triangles
  SurfaceDefect non_manifold_vertices;  ///< vertices of more than one fan of triangles
  SurfaceDefect degenerate_triangles;   ///< corners on one line, to rounding
  SurfaceDefect duplicate_vertices;     ///< same place as an earlier vertex
  SurfaceDefect isolated_vertices;      ///< vertices of no triangle
  SurfaceDefect self_intersections;  ///< pairs of triangles that meet off their corners
  SurfaceDefect nested_components;   ///< parts in another part that face as it does
  bool flat = false;                 ///< closed, but encloses no volume

  [[nodiscard]] bool in_a_plane() const;        ///< one that lies across an axis
  [[nodiscard]] Eigen::Index specks() const;    ///< parts that are too small to matter
  [[nodiscard]] Eigen::Index cavities() const;  ///< parts that are walls of cavities
  [[nodiscard]] bool closed() const { return border_edges.count == 0; }
  /// Closed, and all triangles agree on the outside: volume_m3 is that of the inside.
  [[nodiscard]] bool has_volume() const {
    return closed() && flipped_edges.count == 0 && non_manifold_edges.count == 0 &&
           nested_components.count == 0;
  }
  /// Whether the surface bounds a body that can be meshed.
  [[nodiscard]] bool accepted() const;
  /// One line: what the body is, or every defect with its number and first place.
  [[nodiscard]] std::string verdict() const;
};

/// A place as messages give it, without the unit: "(x, y, z)".
[[nodiscard]] std::string place_text(const Eigen::Vector3d& p);

/// Mean of a triangle's three corners [m].
[[nodiscard]] Eigen::Vector3d triangle_middle_m(const SurfaceMesh& mesh,
                                                Eigen::Index triangle);

/// Smallest of a triangle's three angles [rad].
[[nodiscard]] double smallest_angle_rad(const SurfaceMesh& mesh, Eigen::Index triangle);

/// One kind of defect: where the report holds it and how it is named.
struct DefectKind {
  SurfaceDefect SurfaceReport::*defect;
  const char* key;  ///< in reports for programs
  const char* one;  ///< in a sentence
  const char* many;
};

/// Every kind that refuses a body, in the order in which a message names them.
[[nodiscard]] const std::array<DefectKind, 9>& defect_kinds();

/// A surface that bounds a body, and what was found out about it.
struct CheckedSurface {
  SurfaceMesh mesh;  ///< the input; parts that were inside out have been turned
  SurfaceReport report;
};

/// Looks for every defect. A closed part that is inside out is turned (its triangles'
/// second and third corners change places; vertices stay) and counted. A part inside
/// another is the wall of a cavity, and its outside the cavity. A part in a cavity is
/// an island of the body. A cavity's wall that faces as the part around it does might
/// be an inclusion: it is turned, but a defect. Never throws for a defect.
/// Self-intersections are decided with exact predicates (CGAL).
[[nodiscard]] CheckedSurface check_surface(SurfaceMesh mesh);

/// check_surface, for callers that need a body.
/// @throws InputError "<name>: <verdict>" unless the report is accepted.
[[nodiscard]] CheckedSurface require_body(SurfaceMesh mesh, std::string_view name);

}  // namespace palpate
