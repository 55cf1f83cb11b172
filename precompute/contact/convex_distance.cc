#include "precompute/contact/convex_distance.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

namespace palpate {
namespace {

using Planar = std::vector<Eigen::Vector2d>;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// One side of the convex hull of points that are sorted by x (monotone chain).
template <typename Iterator>
Planar hull_side(Iterator begin, Iterator end) {
  Planar side;
  for (Iterator p = begin; p != end; ++p) {
    while (side.size() > 1 && cross(side.back() - side[side.size() - 2],
                                    *p - side[side.size() - 2]) <= 0.0) {
      side.pop_back();
    }
    side.push_back(*p);
  }
  side.pop_back();  // the other side begins there
  return side;
}

double hull_area(Planar points) {
  std::sort(points.begin(), points.end(),
            [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
              return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
            });
  Planar hull = hull_side(points.begin(), points.end());
  const Planar upper = hull_side(points.rbegin(), points.rend());
  hull.insert(hull.end(), upper.begin(), upper.end());
  double twice = 0.0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    twice += cross(hull[i], hull[(i + 1) % hull.size()]);
  }
  return 0.5 * twice;
}

}  // namespace

TriangleCorners corners_of(const SurfaceMesh& mesh, Eigen::Index triangle) {
  return {mesh.position_m.row(mesh.triangle(triangle, 0)).transpose(),
          mesh.position_m.row(mesh.triangle(triangle, 1)).transpose(),
          mesh.position_m.row(mesh.triangle(triangle, 2)).transpose()};
}

void take_nearer(NearestPoint& nearest, const Eigen::Vector3d& p_m,
                 const TriangleCorners& corner) {
  const Eigen::Vector3d normal =
      (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
  const auto offer = [&](const Eigen::Vector3d& at, int corners,
                         const Eigen::Vector3d& edge) {
    const double distance = (p_m - at).norm();
    if (distance < nearest.distance_m) {
      nearest = {distance, at, corners, edge, normal};
    }
  };
  // A point outside the plane through an edge, along the normal, may be nearest to that
  // edge or its ends. t is the foot of the perpendicular on a + t edge.
  bool inside = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d& a = corner[k];
    const Eigen::Vector3d edge = corner[(k + 1) % 3] - a;
    if (normal.cross(edge).dot(p_m - a) < 0.0) {
      inside = false;
      const double t = edge.dot(p_m - a) / edge.squaredNorm();
      const int corners = t > 0.0 && t < 1.0 ? 2 : 1;
      offer(a + std::clamp(t, 0.0, 1.0) * edge, corners, edge);
    }
  }
  // Otherwise the nearest point is the projection on the triangle's plane.
  if (inside) {
    offer(p_m - normal.dot(p_m - corner[0]) * normal, 3, Eigen::Vector3d::Zero());
  }
}

double shadow_area_m2(const SurfaceMesh& mesh, double depth_m) {
  // The part below `top` is convex. Its corners are the mesh's low corners and the
  // edges' crossings of z = top; their hull in (x, y) is the shadow.
  const double top = mesh.position_m.col(2).minCoeff() + depth_m;
  Planar points;
  for (Eigen::Index i = 0; i < mesh.triangle.rows(); ++i) {
    const TriangleCorners corner = corners_of(mesh, i);
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d& a = corner[k];
      const Eigen::Vector3d& b = corner[(k + 1) % 3];
      if (a.z() <= top) {
        points.emplace_back(a.head<2>());
      }
      if ((a.z() - top) * (b.z() - top) < 0.0) {
        const double t = (top - a.z()) / (b.z() - a.z());
        points.emplace_back((a + t * (b - a)).head<2>());
      }
    }
  }
  return points.size() < 3 ? 0.0 : hull_area(points);
}

}  // namespace palpate
