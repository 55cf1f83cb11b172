#include "precompute/contact/held_obstacle.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace palpate {
namespace {

constexpr int kPointsOfEdge = 7;
constexpr double kOverlap = 0.02;    // [-] of the largest depth
constexpr double kLeastDepth = 0.1;  // [-] of the largest depth
constexpr int kSearchSteps = 32;     // of the search along the path
constexpr int kHalvings = 12;        // of the step that meets something

bool is_met(std::span<const HeldPoint> held, const IndentationPath& path,
            double penetration_m) {
  const PlacedTool tool = tool_at(path, penetration_m);
  const double least_m = -kOverlap * path.depth_max_m;
  return std::any_of(held.begin(), held.end(), [&](const HeldPoint& point) {
    if (distance_m(tool, point.position_m) >= least_m) {
      return false;
    }
    return distance(tool, point.position_m).normal.dot(point.normal) < 0.0;
  });
}

std::vector<HeldPoint> near_path(std::span<const HeldPoint> held,
                                 const IndentationPath& path) {
  const double reach_m = patch_radius_m(path, 0.0) + path.depth_max_m;
  std::vector<HeldPoint> near;
  std::copy_if(held.begin(), held.end(), std::back_inserter(near),
               [&](const HeldPoint& point) {
                 const Eigen::Vector3d to = point.position_m - path.vertex_m;
                 const double along = to.dot(path.outward);
                 return (to - along * path.outward).norm() <= reach_m;
               });
  return near;
}

}  // namespace

std::vector<HeldPoint> held_points(
    const SurfaceMesh& surface,
    const std::function<bool(const Eigen::Vector3d&)>& is_held) {
  std::vector<char> held(static_cast<std::size_t>(surface.position_m.rows()));
  for (std::size_t v = 0; v < held.size(); ++v) {
    held[v] = is_held(surface.position_m.row(static_cast<Eigen::Index>(v)).transpose())
                  ? 1
                  : 0;
  }
  std::vector<HeldPoint> points;
  for (const auto& row : surface.triangle.rowwise()) {
    const auto corner = [&](int j) -> Eigen::Vector3d {
      return surface.position_m.row(row[j % 3]).transpose();
    };
    const auto is = [&](int j) {
      return held[static_cast<std::size_t>(row[j % 3])] != 0;
    };
    const Eigen::Vector3d normal =
        (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
    for (int j = 0; j < 3; ++j) {
      // Points at t = k / 8 of the edge from j to j + 1: k = 0 is the corner itself. A
      // corner whose next corner is free contributes alone. The other triangle of the
      // edge gives the same places with its own normal.
      const int inner = is(j + 1) ? kPointsOfEdge : 0;
      for (int k = 0; is(j) && k <= inner; ++k) {
        const double t = static_cast<double>(k) / (kPointsOfEdge + 1);
        points.push_back({(1.0 - t) * corner(j) + t * corner(j + 1), normal});
      }
    }
  }
  return points;
}

double depth_until_held_m(std::span<const HeldPoint> held,
                          const IndentationPath& path) {
  const std::vector<HeldPoint> near = near_path(held, path);
  double free_m = 0.0;
  for (int k = 1; k <= kSearchSteps; ++k) {
    double met_m = path.depth_max_m * k / kSearchSteps;
    if (!is_met(near, path, met_m)) {
      free_m = met_m;
      continue;
    }
    // Bisection of the first step that meets a held point.
    for (int i = 0; i < kHalvings; ++i) {
      const double middle_m = 0.5 * (free_m + met_m);
      (is_met(near, path, middle_m) ? met_m : free_m) = middle_m;
    }
    return std::max(free_m, kLeastDepth * path.depth_max_m);
  }
  return path.depth_max_m;
}

}  // namespace palpate
