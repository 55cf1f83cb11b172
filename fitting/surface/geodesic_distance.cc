#include "fitting/surface/geodesic_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

namespace palpate {
namespace {

// Arrival at c of a plane front that passed a and b at these distances; along the edges
// where the front comes from outside the triangle.
double arrival_m(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                 const Eigen::Vector3d& c, double at_a_m, double at_b_m) {
  const Eigen::Vector3d u = a - c;
  const Eigen::Vector3d v = b - c;
  const double along = std::min(at_a_m + u.norm(), at_b_m + v.norm());
  if (!std::isfinite(at_a_m) || !std::isfinite(at_b_m)) {
    return along;
  }
  Eigen::Matrix2d gram;
  gram << u.dot(u), u.dot(v), u.dot(v), v.dot(v);
  const double determinant = gram.determinant();
  if (!(determinant > 1e-24 * gram(0, 0) * gram(1, 1))) {
    return along;
  }
  // |gradient| = 1 with d_a = t + g.u, d_b = t + g.v: a quadratic in t.
  const Eigen::Matrix2d inverse = gram.inverse();
  const Eigen::Vector2d one = Eigen::Vector2d::Ones();
  const Eigen::Vector2d d(at_a_m, at_b_m);
  const double p = one.dot(inverse * one);
  const double q = one.dot(inverse * d);
  const double r = d.dot(inverse * d) - 1.0;
  const double root = q * q - p * r;
  if (!(root >= 0.0)) {
    return along;
  }
  const double t = (q + std::sqrt(root)) / p;
  const Eigen::Vector2d upwind = inverse * (d - t * one);
  return upwind.maxCoeff() <= 0.0 ? std::min(t, along) : along;
}

using Entry = std::pair<double, std::int32_t>;
using Front = std::priority_queue<Entry, std::vector<Entry>, std::greater<>>;

}  // namespace

Eigen::VectorXd geodesic_distance_m(const SurfaceMesh& mesh,
                                    std::span<const AttachedPoint> source) {
  const Eigen::Index n = mesh.position_m.rows();
  std::vector<std::vector<Eigen::Index>> around(static_cast<std::size_t>(n));
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    for (const std::int32_t v : mesh.triangle.row(t)) {
      around[static_cast<std::size_t>(v)].push_back(t);
    }
  }
  Eigen::VectorXd distance =
      Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
  Front front;
  const auto reach = [&](std::int32_t v, double d) {
    if (d < distance[v]) {
      distance[v] = d;
      front.push({d, v});
    }
  };
  // 1. Sources reach the corners of their triangles straight.
  for (const AttachedPoint& s : source) {
    const Eigen::Vector3d p = position_m(mesh, s);
    for (const std::int32_t v : mesh.triangle.row(s.triangle)) {
      reach(v, (mesh.position_m.row(v).transpose() - p).norm());
    }
  }
  // 2. Fast marching (Kimmel, Sethian 1998), nearest vertex first. A vertex is reached
  //    again where a later front is nearer, as behind obtuse triangles. Entries that
  //    have become too far are skipped.
  while (!front.empty()) {
    const auto [d, v] = front.top();
    front.pop();
    if (d > distance[v]) {
      continue;
    }
    for (const Eigen::Index t : around[static_cast<std::size_t>(v)]) {
      for (Eigen::Index c = 0; c < 3; ++c) {
        const std::int32_t k = mesh.triangle(t, c);
        if (k != v) {
          const std::int32_t i = mesh.triangle(t, (c + 1) % 3);
          const std::int32_t j = mesh.triangle(t, (c + 2) % 3);
          reach(k, arrival_m(mesh.position_m.row(i), mesh.position_m.row(j),
                             mesh.position_m.row(k), distance[i], distance[j]));
        }
      }
    }
  }
  return distance;
}

}  // namespace palpate
