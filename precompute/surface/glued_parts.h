// Bodies in one file that share faces, edges or vertices.
#pragma once

#include <cstddef>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

/// The surface without walls inside it. A wall is a sheet that ends at edges of three
/// triangles, as where two closed surfaces share faces, each listed once. (clean_soup()
/// takes out faces listed twice.) Bodies that shared a wall are one body there. The
/// winding number of the rest decides whether a sheet lies inside.
/// @param walls gains the number of sheets taken out.
[[nodiscard]] SurfaceMesh without_inner_walls(const SurfaceMesh& mesh,
                                              std::size_t& walls);

/// Parts a closed surface where it touches itself in vertices, or in edges of four
/// triangles or more. Triangles with the body between them stay together. Touching
/// places get vertices of their own, a thousandth of an edge inside the body from the
/// old place. Old vertices stay. An edge whose triangles do not face in and out by
/// turns stays as it is, and so does a surface with a border.
/// @param added gains the number of new vertices.
[[nodiscard]] SurfaceMesh part_touching(const SurfaceMesh& mesh, std::size_t& added);

}  // namespace palpate
