#include "precompute/surface/repair_topology.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include <CGAL/Bbox_3.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/manifoldness.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include "precompute/surface/cgal_surface.h"

namespace palpate {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;

// Whether b runs around the same places against a: turned. Splitting changes numbers,
// so places are compared.
bool turned(const CgalSoup& a, const CgalSoup& b, std::size_t t) {
  std::array<CgalKernel::Point_3, 3> p;
  std::array<CgalKernel::Point_3, 3> q;
  for (std::size_t j = 0; j < 3; ++j) {
    p[j] = a.point[a.triangle[t][j]];
    q[j] = b.point[b.triangle[t][j]];
  }
  std::rotate(q.begin(), std::find(q.begin(), q.end(), p[0]), q.end());
  return q[1] != p[1];
}

CgalMesh oriented(const SurfaceMesh& mesh, TopologyChanges& changes) {
  const CgalSoup before = to_cgal_soup(mesh);
  CgalSoup soup = before;
  pmp::orient_polygon_soup(soup.point, soup.triangle);
  changes.split_vertices += soup.point.size() - before.point.size();
  std::size_t against = 0;
  for (std::size_t t = 0; t < soup.triangle.size(); ++t) {
    against += turned(before, soup, t) ? 1U : 0U;
  }
  // The whole may have been turned; what matters is who disagreed.
  changes.turned_triangles += std::min(against, soup.triangle.size() - against);
  CgalMesh result;
  pmp::polygon_soup_to_polygon_mesh(soup.point, soup.triangle, result);
  return result;
}

double hole_diagonal(const CgalMesh& mesh, CgalMesh::Halfedge_index border) {
  CGAL::Bbox_3 box;
  for (const auto h : CGAL::halfedges_around_face(border, mesh)) {
    box += mesh.point(mesh.target(h)).bbox();
  }
  return std::hypot(box.xmax() - box.xmin(), box.ymax() - box.ymin(),
                    box.zmax() - box.zmin());
}

std::size_t fill_holes(CgalMesh& mesh, double hole_max_m) {
  std::vector<CgalMesh::Halfedge_index> borders;
  pmp::extract_boundary_cycles(mesh, std::back_inserter(borders));
  std::size_t filled = 0;
  for (const auto border : borders) {
    if (hole_diagonal(mesh, border) <= hole_max_m) {
      std::vector<CgalMesh::Face_index> patch;
      pmp::triangulate_hole(mesh, border, std::back_inserter(patch));
      filled += patch.empty() ? 0U : 1U;
    }
  }
  return filled;
}

}  // namespace

SurfaceMesh close_holes(const SurfaceMesh& mesh, TopologyChanges& changes) {
  return repair_topology(mesh, std::numeric_limits<double>::infinity(), changes);
}

SurfaceMesh repair_topology(const SurfaceMesh& mesh, double hole_max_m,
                            TopologyChanges& changes) {
  CgalMesh surface = oriented(mesh, changes);
  changes.stitched_borders += pmp::stitch_borders(surface);
  changes.split_vertices += pmp::duplicate_non_manifold_vertices(surface);
  const std::size_t faces = surface.number_of_faces();
  pmp::remove_degenerate_faces(surface);
  changes.degenerate_triangles += faces - surface.number_of_faces();
  changes.filled_holes += fill_holes(surface, hole_max_m);
  return from_cgal(std::move(surface));
}

}  // namespace palpate
