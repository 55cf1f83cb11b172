#include "runtime/element/smooth_edges.h"

#include <cstddef>

#include <Eigen/Geometry>

namespace palpate {
namespace {

using Index = Eigen::Index;

void put(EdgeVectors& to, Index i, const Vector3& value) {
  to.x(i) = value.x();
  to.y(i) = value.y();
  to.z(i) = value.z();
}

// What the edge opposite corner i alone fixes, as lane `to`.
void put_edge(SmoothTriangle& t, Index i, Index to, Real touch_height_m) {
  const Index j = after(i);
  const Index k = after(j);
  SmoothEdges& edges = t.edges;
  const Vector3 n = t.normal.col(j);
  const Vector3 e = t.corner_m.col(k) - t.corner_m.col(j);
  const Vector3 bend = t.normal.col(k) - n;
  const Vector3 inwards = (n + t.normal.col(k)).cross(e);
  const Real length = inwards.norm();
  const Vector3 m = length > 0.0 ? Vector3(inwards / length) : Vector3::Zero();
  put(edges.start_m, to, t.corner_m.col(j));
  put(edges.edge_m, to, e);
  put(edges.normal, to, n);
  put(edges.bend, to, bend);
  put(edges.across, to, m);
  put(edges.turned, to, m.cross(n));
  put(edges.turning, to, m.cross(bend));
  edges.open_m(to) = e.dot(m.cross(n));
  edges.closing_m(to) = e.dot(m.cross(bend));
  edges.edge_normal_m(to) = e.dot(n);
  edges.edge_bend_m(to) = e.dot(bend);
  edges.across_normal(to) = m.dot(n);
  edges.across_bend(to) = m.dot(bend);
  edges.normal_squared(to) = n.squaredNorm();
  edges.normal_bend(to) = n.dot(bend);
  edges.bend_squared(to) = bend.squaredNorm();
  const Real area = e.cross(Vector3(t.corner_m.col(i) - t.corner_m.col(j))).norm();
  edges.per_altitude_m(to) = area > 0.0 ? e.norm() / area : Real(0.0);
  // (fall + s falling) . (e + s bend), straight in s about the height h: with s^2 = 2 h
  // s - h^2.
  const Vector3 fall = t.rise.col(j) - t.rise.col(k);
  const Vector3 falling = t.rise_by_height_per_m.col(j) - t.rise_by_height_per_m.col(k);
  const Real both = falling.dot(bend) * touch_height_m;
  edges.gap_m(to) = fall.dot(e) - both * touch_height_m;
  edges.gap(to) = -fall.dot(bend) - falling.dot(e) - 2.0 * both;
  edges.twist(to) = -fall.dot(m);
  edges.twist_by_height_per_m(to) = -falling.dot(m);
}

// The three gammas are the height's second differences along the edges; kappa is that
// towards corner i, u the foot of its altitude.
void put_sag(SmoothTriangle& t, Index i, Index to) {
  const Index j = after(i);
  const Index k = after(j);
  SmoothEdges& edges = t.edges;
  const Vector3 e = edges.edge_m.at(i);
  const Vector3 up = t.corner_m.col(i) - t.corner_m.col(j);
  const Real length2 = e.squaredNorm();
  const Real u = length2 > 0.0 ? up.dot(e) / length2 : Real(0.0);
  // Edge k goes from i to j, edge j from k to i.
  edges.sag_m(to) =
      (1.0 - u) * edges.gap_m(k) + u * edges.gap_m(j) - u * (1.0 - u) * edges.gap_m(i);
  edges.sag(to) =
      (1.0 - u) * edges.gap(k) + u * edges.gap(j) - u * (1.0 - u) * edges.gap(i);
}

}  // namespace

SmoothTriangle make_smooth_triangle(const Element& element) noexcept {
  SmoothTriangle triangle;
  for (std::size_t j = 0; j < 3; ++j) {
    const auto column = static_cast<Index>(j);
    const ElementNode& node = element.node[j];
    triangle.corner_m.col(column) = Eigen::Map<const Vector3>(node.position_m.data());
    triangle.normal.col(column) = Eigen::Map<const Vector3>(node.normal.data());
    triangle.rise.col(column) =
        triangle.normal.col(column) + Eigen::Map<const Vector3>(node.tilt.data());
    triangle.rise_by_height_per_m.col(column) =
        Eigen::Map<const Vector3>(node.tilt_by_height_per_m.data());
  }
  for (Index lane = 0; lane < 4; ++lane) {
    put_edge(triangle, lane % 3, lane, element.touch_height_m);
  }
  for (Index lane = 0; lane < 4; ++lane) {
    put_sag(triangle, lane % 3, lane);
  }
  return triangle;
}

}  // namespace palpate
