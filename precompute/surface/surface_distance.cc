#include "precompute/surface/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

namespace palpate {
namespace {

using PlainKernel = CGAL::Simple_cartesian<double>;
using Triangle = PlainKernel::Triangle_3;
using Primitive =
    CGAL::AABB_triangle_primitive<PlainKernel, std::vector<Triangle>::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<PlainKernel, Primitive>>;

PlainKernel::Point_3 point(const SurfaceMesh& mesh, Eigen::Index t, Eigen::Index j) {
  const auto p = mesh.position_m.row(mesh.triangle(t, j));
  return {p.x(), p.y(), p.z()};
}

// Those without area have no nearest point to speak of.
std::vector<Triangle> triangles(const SurfaceMesh& mesh) {
  std::vector<Triangle> result;
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    const Triangle one(point(mesh, t, 0), point(mesh, t, 1), point(mesh, t, 2));
    if (!one.is_degenerate()) {
      result.push_back(one);
    }
  }
  return result;
}

}  // namespace

double distance_to_surface_m(const SurfaceMesh& from, const SurfaceMesh& to) {
  const std::vector<Triangle> target = triangles(to);
  const Tree tree(target.begin(), target.end());
  double largest2 = 0.0;
  for (Eigen::Index t = 0; t < from.triangle.rows(); ++t) {
    const PlainKernel::Point_3 a = point(from, t, 0);
    const PlainKernel::Point_3 b = point(from, t, 1);
    const PlainKernel::Point_3 c = point(from, t, 2);
    for (const PlainKernel::Point_3& p : {a, b, c, CGAL::centroid(a, b, c)}) {
      largest2 = std::max(largest2, tree.squared_distance(p));
    }
  }
  return std::sqrt(largest2);
}

}  // namespace palpate
