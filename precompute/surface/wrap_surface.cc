#include "precompute/surface/wrap_surface.h"

#include <utility>

#include <CGAL/alpha_wrap_3.h>

#include "precompute/surface/cgal_surface.h"

namespace palpate {

SurfaceMesh wrap_surface(const SurfaceMesh& mesh, double opening_m, double offset_m) {
  const CgalSoup soup = to_cgal_soup(mesh);
  CgalMesh wrap;
  CGAL::alpha_wrap_3(soup.point, soup.triangle, opening_m, offset_m, wrap);
  return from_cgal(std::move(wrap));
}

}  // namespace palpate
