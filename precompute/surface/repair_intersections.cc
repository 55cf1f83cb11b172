#include "precompute/surface/repair_intersections.h"

#include <utility>

#include <CGAL/Polygon_mesh_processing/repair_self_intersections.h>

#include "precompute/surface/cgal_surface.h"

namespace palpate {

SurfaceMesh repair_intersections(const SurfaceMesh& mesh) {
  CgalMesh surface = to_cgal(mesh);
  CGAL::Polygon_mesh_processing::experimental::remove_self_intersections(
      surface, CGAL::parameters::preserve_genus(false));
  return from_cgal(std::move(surface));
}

}  // namespace palpate
