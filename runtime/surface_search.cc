#include "runtime/surface_search.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "formats/response_table.h"

namespace palpate {
namespace {

constexpr std::int32_t kLeafTriangles = 4;
constexpr std::size_t kStack = 64;  // median splits: depth <= log2(2^31)

constexpr std::size_t at(std::int32_t i) {
  return static_cast<std::size_t>(i);
}

// Nearest point of edge (j, j+1).
SurfacePoint nearest_in_edge(const Eigen::Matrix3d& corner, int j,
                             const Eigen::Vector3d& p) noexcept {
  const int k = (j + 1) % 3;
  const Eigen::Vector3d a = corner.row(j).transpose();
  const Eigen::Vector3d edge = corner.row(k).transpose() - a;
  const double length2 = edge.squaredNorm();
  const double t =
      length2 > 0.0 ? std::clamp(edge.dot(p - a) / length2, 0.0, 1.0) : 0.0;
  SurfacePoint point;
  point.area_coordinate[j] = 1.0 - t;
  point.area_coordinate[k] = t;
  point.position_m = a + t * edge;
  point.distance_m = (p - point.position_m).norm();
  return point;
}

}  // namespace

SurfacePoint nearest_in_triangle(const Eigen::Matrix3d& corner_m,
                                 const Eigen::Vector3d& p_m) noexcept {
  const Eigen::Vector3d n = area_coordinates(corner_m, p_m);
  const Eigen::Vector3d a = corner_m.row(0).transpose();
  const bool has_area = (corner_m.row(1).transpose() - a)
                            .cross(corner_m.row(2).transpose() - a)
                            .squaredNorm() > 0.0;
  if (has_area && n.minCoeff() >= 0.0) {
    SurfacePoint point{.area_coordinate = n, .position_m = corner_m.transpose() * n};
    point.distance_m = (p_m - point.position_m).norm();
    return point;
  }
  SurfacePoint best = nearest_in_edge(corner_m, 0, p_m);
  for (int j = 1; j < 3; ++j) {
    const SurfacePoint other = nearest_in_edge(corner_m, j, p_m);
    if (other.distance_m < best.distance_m) {
      best = other;
    }
  }
  return best;
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
  struct Open {
    std::int32_t box;
    double distance2;
  };
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
      const SurfacePoint point = nearest_in(order_[at(i)], p_m);
      if (point.distance_m < best.distance_m) {
        best = point;
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

SurfacePoint SurfaceSearch::walk(const Eigen::Vector3d& p_m,
                                 std::int32_t triangle) const noexcept {
  SurfacePoint best = nearest_in(triangle, p_m);
  for (bool nearer = true; nearer;) {
    nearer = false;
    const std::int32_t from = best.triangle;
    for (int j = 0; j < 3; ++j) {
      const std::size_t v = at(mesh_.triangle(from, j));
      for (std::int32_t i = vertex_begin_[v]; i < vertex_begin_[v + 1]; ++i) {
        const SurfacePoint point = nearest_in(vertex_triangle_[at(i)], p_m);
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
