#include "formats/mesh/surface_search.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "formats/base/at.h"

namespace palpate {
namespace {

constexpr std::int32_t kLeafTriangles = 4;
constexpr double kNearer = 1e-9;    // [-] what may be rounding, of a distance
constexpr double kNearerM = 1e-12;  // [m] and of coordinates
constexpr std::size_t kStack = 64;  // median splits: depth <= log2(2^31)

// Nearest point of edge (j, j+1), a share t of it from corner j.
SurfacePoint in_edge(const Eigen::Matrix3d& corner, int j, double t,
                     const Eigen::Vector3d& p) noexcept {
  const int k = (j + 1) % 3;
  SurfacePoint point;
  point.area_coordinate[j] = 1.0 - t;
  point.area_coordinate[k] = t;
  point.position_m = ((1.0 - t) * corner.row(j) + t * corner.row(k)).transpose();
  point.distance_m = (p - point.position_m).norm();
  return point;
}

// Of a triangle without area, or that rounding leaves without a side.
SurfacePoint nearest_in_edges(const Eigen::Matrix3d& corner,
                              const Eigen::Vector3d& p) noexcept {
  SurfacePoint best;
  best.distance_m = std::numeric_limits<double>::infinity();
  for (int j = 0; j < 3; ++j) {
    const Eigen::Vector3d a = corner.row(j).transpose();
    const Eigen::Vector3d edge = corner.row((j + 1) % 3).transpose() - a;
    const double length2 = edge.squaredNorm();
    const double t =
        length2 > 0.0 ? std::clamp(edge.dot(p - a) / length2, 0.0, 1.0) : 0.0;
    const SurfacePoint point = in_edge(corner, j, t, p);
    if (point.distance_m < best.distance_m) {
      best = point;
    }
  }
  return best;
}

// Whether all of a triangle lies further than distance_m along the unit vector
// `toward`, by more than rounding. A plane across the way to the nearest point so far
// has most of a surface behind it.
bool is_behind(const SurfaceMesh& mesh, std::int32_t triangle,
               const Eigen::Vector3d& p_m, const Eigen::Vector3d& toward,
               double distance_m) noexcept {
  double along_m = std::numeric_limits<double>::infinity();
  for (int j = 0; j < 3; ++j) {
    const Eigen::Vector3d corner = mesh.position_m.row(mesh.triangle(triangle, j));
    along_m = std::min(along_m, toward.dot(corner - p_m));
  }
  return along_m > distance_m * (1.0 + kNearer) + kNearerM;
}

}  // namespace

// By the regions that the corners' and the edges' perpendicular planes part (Ericson,
// Real-Time Collision Detection, 5.1.5): a few dot products where it is decided early.
SurfacePoint nearest_in_triangle(const Eigen::Matrix3d& corner_m,
                                 const Eigen::Vector3d& p_m) noexcept {
  const Eigen::Vector3d a = corner_m.row(0).transpose();
  const Eigen::Vector3d ab = corner_m.row(1).transpose() - a;
  const Eigen::Vector3d ac = corner_m.row(2).transpose() - a;
  const Eigen::Vector3d ap = p_m - a;
  const double ab_ap = ab.dot(ap);
  const double ac_ap = ac.dot(ap);
  const double ab_bp = ab_ap - ab.squaredNorm();
  const double ac_cp = ac_ap - ac.squaredNorm();
  const double ac_bp = ac_ap - ab.dot(ac);
  const double ab_cp = ab_ap - ab.dot(ac);
  if (ab_ap <= 0.0 && ac_ap <= 0.0) {
    return in_edge(corner_m, 0, 0.0, p_m);
  }
  if (ab_bp >= 0.0 && ac_bp <= ab_bp) {
    return in_edge(corner_m, 1, 0.0, p_m);
  }
  if (ac_cp >= 0.0 && ab_cp <= ac_cp) {
    return in_edge(corner_m, 2, 0.0, p_m);
  }
  // Twice the areas of p's projection with the edges, times twice the triangle's.
  const double beside_ab = ab_ap * ac_bp - ab_bp * ac_ap;
  if (beside_ab <= 0.0 && ab_ap > 0.0 && ab_bp < 0.0) {
    return in_edge(corner_m, 0, ab_ap / (ab_ap - ab_bp), p_m);
  }
  const double beside_ac = ab_cp * ac_ap - ab_ap * ac_cp;
  if (beside_ac <= 0.0 && ac_ap > 0.0 && ac_cp < 0.0) {
    return in_edge(corner_m, 2, ac_cp / (ac_cp - ac_ap), p_m);
  }
  const double beside_bc = ab_bp * ac_cp - ab_cp * ac_bp;
  const double from_b = ac_bp - ab_bp;
  const double from_c = ab_cp - ac_cp;
  if (beside_bc <= 0.0 && from_b > 0.0 && from_c > 0.0) {
    return in_edge(corner_m, 1, from_b / (from_b + from_c), p_m);
  }
  const double all = beside_ab + beside_ac + beside_bc;
  if (!(beside_ab > 0.0 && beside_ac > 0.0 && beside_bc > 0.0)) {
    return nearest_in_edges(corner_m, p_m);
  }
  SurfacePoint point;
  point.area_coordinate = Eigen::Vector3d(beside_bc, beside_ac, beside_ab) / all;
  point.position_m = a + point.area_coordinate[1] * ab + point.area_coordinate[2] * ac;
  point.distance_m = (p_m - point.position_m).norm();
  return point;
}

SurfaceSearch::SurfaceSearch(const SurfaceMesh& mesh)
    : mesh_(mesh),
      neighbour_(triangle_neighbours(mesh.triangle)),
      order_(static_cast<std::size_t>(mesh.triangle.rows())),
      vertex_begin_(static_cast<std::size_t>(mesh.position_m.rows()) + 1, 0),
      vertex_triangle_(static_cast<std::size_t>(3 * mesh.triangle.rows())) {
  const auto triangles = static_cast<std::int32_t>(mesh.triangle.rows());
  std::vector<Eigen::AlignedBox3d> bounds(order_.size());
  for (std::int32_t t = 0; t < triangles; ++t) {
    for (int j = 0; j < 3; ++j) {
      const std::int32_t v = mesh.triangle(t, j);
      bounds[at(t)].extend(Eigen::Vector3d(mesh.position_m.row(v).transpose()));
      ++vertex_begin_[at(v) + 1];
    }
  }
  // Counts become beginnings: vertex v has vertex_triangle_ from vertex_begin_[v] to
  // vertex_begin_[v + 1].
  std::partial_sum(vertex_begin_.begin(), vertex_begin_.end(), vertex_begin_.begin());
  std::vector<std::int32_t> next(vertex_begin_.begin(), vertex_begin_.end() - 1);
  for (std::int32_t t = 0; t < triangles; ++t) {
    for (int j = 0; j < 3; ++j) {
      vertex_triangle_[at(next[at(mesh.triangle(t, j))]++)] = t;
    }
  }
  std::iota(order_.begin(), order_.end(), 0);
  if (triangles > 0) {
    box_.emplace_back();
    build(0, 0, triangles, bounds);
  }
}

void SurfaceSearch::build(std::int32_t box, std::int32_t begin, std::int32_t end,
                          const std::vector<Eigen::AlignedBox3d>& bounds) {
  Eigen::AlignedBox3d all;
  Eigen::AlignedBox3d centres;
  for (std::int32_t i = begin; i < end; ++i) {
    all.extend(bounds[at(order_[at(i)])]);
    centres.extend(bounds[at(order_[at(i)])].center());
  }
  box_[at(box)].bounds = all;
  if (end - begin <= kLeafTriangles) {
    box_[at(box)].first = begin;
    box_[at(box)].count = end - begin;
    return;
  }
  // Halves by the median along the longest side, so that the depth is bounded.
  Eigen::Index axis = 0;
  centres.sizes().maxCoeff(&axis);
  const std::int32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle,
                   order_.begin() + end, [&](std::int32_t a, std::int32_t b) {
                     return bounds[at(a)].center()[axis] < bounds[at(b)].center()[axis];
                   });
  const auto child = static_cast<std::int32_t>(box_.size());
  box_[at(box)].first = child;
  box_.resize(box_.size() + 2);
  build(child, begin, middle, bounds);
  build(child + 1, middle, end, bounds);
}

SurfacePoint SurfaceSearch::nearest_in(std::int32_t triangle,
                                       const Eigen::Vector3d& p_m) const noexcept {
  Eigen::Matrix3d corner;
  for (int j = 0; j < 3; ++j) {
    corner.row(j) = mesh_.position_m.row(mesh_.triangle(triangle, j));
  }
  SurfacePoint point = nearest_in_triangle(corner, p_m);
  point.triangle = triangle;
  return point;
}

SurfacePoint SurfaceSearch::nearest(const Eigen::Vector3d& p_m) const noexcept {
  SurfacePoint best;
  best.distance_m = std::numeric_limits<double>::infinity();
  if (box_.empty() || !p_m.allFinite()) {
    return best;
  }
  Eigen::Vector3d toward = Eigen::Vector3d::Zero();
  struct Open {
    std::int32_t box;
    double distance2;
  };
  // Boxes that may hold a nearer point. The nearer child is opened first, so that most
  // others are then too far to be opened.
  std::array<Open, kStack> stack{};
  std::size_t open = 0;
  stack[open++] = {0, box_[0].bounds.squaredExteriorDistance(p_m)};
  while (open > 0) {
    const Open top = stack[--open];
    if (top.distance2 > best.distance_m * best.distance_m) {
      continue;
    }
    const Box& box = box_[at(top.box)];
    for (std::int32_t i = box.first; i < box.first + box.count; ++i) {
      const std::int32_t t = order_[at(i)];
      if (is_behind(mesh_, t, p_m, toward, best.distance_m)) {
        continue;
      }
      const SurfacePoint point = nearest_in(t, p_m);
      if (point.distance_m < best.distance_m) {
        best = point;
        toward = (best.position_m - p_m) / best.distance_m;
      }
    }
    if (box.count == 0) {
      Open near{box.first, box_[at(box.first)].bounds.squaredExteriorDistance(p_m)};
      Open far{box.first + 1,
               box_[at(box.first + 1)].bounds.squaredExteriorDistance(p_m)};
      if (far.distance2 < near.distance2) {
        std::swap(near, far);
      }
      stack[open++] = far;
      stack[open++] = near;
    }
  }
  return best;
}

bool SurfaceSearch::has_vertex(std::int32_t triangle,
                               std::int32_t vertex) const noexcept {
  return mesh_.triangle(triangle, 0) == vertex ||
         mesh_.triangle(triangle, 1) == vertex || mesh_.triangle(triangle, 2) == vertex;
}

SurfacePoint SurfaceSearch::walk(const Eigen::Vector3d& p_m,
                                 std::int32_t triangle) const noexcept {
  SurfacePoint best = nearest_in(triangle, p_m);
  for (bool nearer = true; nearer;) {
    nearer = false;
    const std::int32_t from = best.triangle;
    for (int j = 0; j < 3; ++j) {
      const std::size_t v = at(mesh_.triangle(from, j));
      for (std::int32_t i = vertex_begin_[v]; i < vertex_begin_[v + 1]; ++i) {
        const std::int32_t t = vertex_triangle_[at(i)];
        if (t == from || (j > 0 && has_vertex(t, mesh_.triangle(from, 0))) ||
            (j > 1 && has_vertex(t, mesh_.triangle(from, 1)))) {
          continue;  // looked at already
        }
        const SurfacePoint point = nearest_in(t, p_m);
        if (point.distance_m < best.distance_m) {
          best = point;
          nearer = true;
        }
      }
    }
  }
  return best;
}

std::size_t SurfaceSearch::around(std::int32_t triangle,
                                  std::span<std::int32_t> to) const noexcept {
  std::size_t count = 0;
  const auto add = [&](std::int32_t t) {
    const auto end = to.begin() + static_cast<std::ptrdiff_t>(count);
    if (t >= 0 && t != triangle && count < to.size() &&
        std::find(to.begin(), end, t) == end) {
      to[count++] = t;
    }
  };
  for (int j = 0; j < 3; ++j) {
    add(neighbour_(triangle, j));
  }
  for (int j = 0; j < 3; ++j) {
    const std::size_t v = at(mesh_.triangle(triangle, j));
    for (std::int32_t i = vertex_begin_[v]; i < vertex_begin_[v + 1]; ++i) {
      add(vertex_triangle_[at(i)]);
    }
  }
  return count;
}

}  // namespace palpate
