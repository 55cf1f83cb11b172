#include "fitting/surface/attached_point.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

// Area coordinates of the point of segment from corner i to corner j nearest to p.
Eigen::Vector3d on_edge(const Eigen::Matrix3d& corner_m, int i, int j,
                        const Eigen::Vector3d& p) {
  const Eigen::Vector3d edge = corner_m.col(j) - corner_m.col(i);
  const double t = std::clamp(
      edge.dot(p - corner_m.col(i)) / std::max(edge.squaredNorm(), 1e-300), 0.0, 1.0);
  Eigen::Vector3d weight = Eigen::Vector3d::Zero();
  weight[i] = 1.0 - t;
  weight[j] = t;
  return weight;
}

// Area coordinates of the triangle's point nearest to p.
Eigen::Vector3d nearest_weights(const Eigen::Matrix3d& corner_m,
                                const Eigen::Vector3d& p) {
  const Eigen::Vector3d a = corner_m.col(1) - corner_m.col(0);
  const Eigen::Vector3d b = corner_m.col(2) - corner_m.col(0);
  const Eigen::Vector3d normal = a.cross(b);
  const double area2 = normal.squaredNorm();
  if (area2 > 0.0) {
    const Eigen::Vector3d r = p - corner_m.col(0);
    // Area coordinates of the projection on the triangle's plane.
    const double v = normal.dot(r.cross(b)) / area2;
    const double w = normal.dot(a.cross(r)) / area2;
    if (v >= 0.0 && w >= 0.0 && v + w <= 1.0) {
      return {1.0 - v - w, v, w};
    }
  }
  Eigen::Vector3d best = on_edge(corner_m, 0, 1, p);
  for (const auto& weight : {on_edge(corner_m, 1, 2, p), on_edge(corner_m, 2, 0, p)}) {
    if ((corner_m * weight - p).squaredNorm() < (corner_m * best - p).squaredNorm()) {
      best = weight;
    }
  }
  return best;
}

Eigen::Matrix3d corners_m(const SurfaceMesh& mesh, std::int32_t triangle) {
  Eigen::Matrix3d corner;
  for (int c = 0; c < 3; ++c) {
    corner.col(c) = mesh.position_m.row(mesh.triangle(triangle, c)).transpose();
  }
  return corner;
}

}  // namespace

AttachedPoint closest_surface_point(const SurfaceMesh& mesh,
                                    const Eigen::Vector3d& point_m) {
  if (!point_m.allFinite() || mesh.triangle.rows() == 0) {
    throw InputError(fmt::format(
        "point ({}, {}, {}) m cannot be attached to a surface of {} triangles",
        point_m.x(), point_m.y(), point_m.z(), mesh.triangle.rows()));
  }
  AttachedPoint best;
  best.distance_m = std::numeric_limits<double>::infinity();
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.triangle.rows()); ++t) {
    const Eigen::Matrix3d corner = corners_m(mesh, t);
    const Eigen::Vector3d weight = nearest_weights(corner, point_m);
    const double distance = (corner * weight - point_m).norm();
    if (distance < best.distance_m) {
      best = {t, weight, distance};
    }
  }
  return best;
}

Eigen::Vector3d position_m(const SurfaceMesh& mesh, const AttachedPoint& point) {
  return corners_m(mesh, point.triangle) * point.weight;
}

std::int32_t main_vertex(const SurfaceMesh& mesh, const AttachedPoint& point) {
  Eigen::Index corner = 0;
  point.weight.maxCoeff(&corner);
  return mesh.triangle(point.triangle, corner);
}

}  // namespace palpate
