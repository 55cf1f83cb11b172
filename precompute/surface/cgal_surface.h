// A surface as CGAL holds it, and back. For the source files that call CGAL alone.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include "formats/mesh/surface_mesh.h"

namespace palpate {

using CgalKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<CgalKernel::Point_3>;

/// Points and triangles as CGAL's functions on soups like them.
struct CgalSoup {
  std::vector<CgalKernel::Point_3> point;
  std::vector<std::vector<std::size_t>> triangle;
};

inline CgalSoup to_cgal_soup(const SurfaceMesh& mesh) {
  CgalSoup soup;
  for (Eigen::Index v = 0; v < mesh.position_m.rows(); ++v) {
    soup.point.emplace_back(mesh.position_m(v, 0), mesh.position_m(v, 1),
                            mesh.position_m(v, 2));
  }
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    soup.triangle.push_back({static_cast<std::size_t>(mesh.triangle(t, 0)),
                             static_cast<std::size_t>(mesh.triangle(t, 1)),
                             static_cast<std::size_t>(mesh.triangle(t, 2))});
  }
  return soup;
}

/// Only for surfaces that are manifold and whose triangles agree on the outside.
inline CgalMesh to_cgal(const SurfaceMesh& mesh) {
  CgalMesh result;
  for (Eigen::Index v = 0; v < mesh.position_m.rows(); ++v) {
    result.add_vertex(
        {mesh.position_m(v, 0), mesh.position_m(v, 1), mesh.position_m(v, 2)});
  }
  const auto vertex = [&](Eigen::Index t, Eigen::Index j) {
    return CgalMesh::Vertex_index(
        static_cast<CgalMesh::size_type>(mesh.triangle(t, j)));
  };
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    result.add_face(vertex(t, 0), vertex(t, 1), vertex(t, 2));
  }
  return result;
}

inline SurfaceMesh from_cgal(CgalMesh mesh) {
  mesh.collect_garbage();
  SurfaceMesh result;
  result.position_m.resize(static_cast<Eigen::Index>(mesh.number_of_vertices()), 3);
  for (const auto v : mesh.vertices()) {
    const CgalKernel::Point_3& p = mesh.point(v);
    result.position_m.row(static_cast<Eigen::Index>(v.idx())) << p.x(), p.y(), p.z();
  }
  result.triangle.resize(static_cast<Eigen::Index>(mesh.number_of_faces()), 3);
  for (const auto f : mesh.faces()) {
    Eigen::Index j = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f))) {
      result.triangle(static_cast<Eigen::Index>(f.idx()), j++) =
          static_cast<std::int32_t>(v.idx());
    }
  }
  return result;
}

}  // namespace palpate
