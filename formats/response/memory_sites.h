// Where a surface remembers being pressed: sites that lie about two contact radii
// apart.
//
// Memory at every node of a finer mesh lets a sliding tool outrun its own footprint;
// memory that is coarser drags the dent along. The comparison is with boundary elements
// of a linear viscoelastic half-space. Normal forces are right within 1 to 3.5 % at two
// contact radii, and within 6 to 13 % at 0.7 to 1.
#pragma once

#include <vector>

#include "formats/mesh/surface_mesh.h"
#include "formats/response/tool_shape.h"
#include "formats/response/viscoelasticity.h"

namespace palpate {

/// Spacings in contact radii between which sliding was found right.
constexpr double kFinestSites = 1.5;
constexpr double kCoarsestSites = 2.5;

/// Radius of the contact of a tool pressed to a depth, on a flat body [m] > 0. Of a
/// sphere the radius is sqrt(R d) (Hertz), of a capsule the half width of the contact,
/// of a punch the punch's own radius. Of a cone the radius is 2 d tan(half-angle) / pi
/// (Sneddon). Of a mesh the radius is that of the sphere that bounds the mesh's lower
/// end as well.
/// @param depth_m [m] > 0
[[nodiscard]] double contact_radius_m(const ToolShape& tool, double depth_m);

/// Sites of a body for a tool, two contact radii of a typical press apart: half the
/// largest depth.
/// @param depth_max_m [m] > 0
[[nodiscard]] double site_spacing_m(const ToolShape& tool, double depth_max_m);

/// A subset of some nodes, each the farthest from those before it that the surface
/// leads to. The subset ends where no node is farther than three quarters of the
/// spacing. Neighbouring sites lie about the spacing apart. Where the mesh is coarser
/// all of them are sites. A node reads the corners of the triangle of sites around it
/// (Delaunay's in the tangent plane) by its area coordinates. At a border the node
/// reads the two nearest sites or the nearest.
/// @param normal  (n x 3) [-] outward.
/// @param remembers (n) whether the node has a response; others have no sites.
/// @param spacing_m [m] > 0
[[nodiscard]] MemorySites place_sites(const SurfaceMesh& body, const Points& normal,
                                      const std::vector<bool>& remembers,
                                      double spacing_m);

/// Mean distance of a site from the nearest other [m]; 0 for less than two.
[[nodiscard]] double mean_spacing_m(const MemorySites& sites, const Points& position_m);

}  // namespace palpate
