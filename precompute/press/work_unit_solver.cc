#include "precompute/press/work_unit_solver.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "precompute/contact/indentation_response.h"
#include "precompute/press/cluster.h"
#include "precompute/press/needle_curve.h"

namespace palpate {
namespace {

// Spreads the indices of vertices evenly and without order (Steele, Lea and Flood
// 2014).
std::uint64_t scrambled(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

// [0, 1), the i-th of a sequence without order.
double evenly(std::uint64_t i) {
  return std::ldexp(static_cast<double>(scrambled(i) >> 11U), -53);
}

constexpr double kTightBudget = 0.03;  // [-] of force

// Of so few vertices most are probably solved: not worth linear presses of all, unless
// a few full ones say otherwise.
bool is_small(std::size_t vertices, double force_relative) {
  return vertices <= (force_relative < kTightBudget ? 76 : 52);
}

std::size_t cluster_size(std::size_t vertices) {
  return std::clamp<std::size_t>((vertices + 3) / 4, 128, 512);
}

WorkUnitOutcome solve_check(const Scene& scene, const BodySource& body,
                            const PressStrategy& strategy, const SceneSolver& solver,
                            const WorkUnit& unit) {
  const double times_finer = check_times_finer(strategy, unit.place);
  WorkUnitOutcome outcome{
      .index = unit.index, .is_check = true, .node = {}, .place = unit.place};
  for (std::size_t t = 0; t < body.tool.size(); ++t) {
    const PressedNode node =
        solver.reference(body.tool[t], unit.vertex.front(), unit.place, times_finer);
    outcome.node.push_back(
        {.tool = static_cast<std::int32_t>(t),
         .vertex = unit.vertex.front(),
         .response = to_response(node.indentation, node.path, scene.force_relative),
         .failure = node.failure});
    fail_if_broken(outcome.node.back());
  }
  return outcome;
}

// Triangles whose vertices are all among these, and their areas summed up.
struct OpenSurface {
  std::vector<std::int32_t> triangle;
  std::vector<double> area_until;

  OpenSurface(const SurfaceMesh& surface, std::span<const std::int32_t> vertices) {
    const auto reaches = [&](std::int32_t v) {
      return std::binary_search(vertices.begin(), vertices.end(), v);
    };
    double sum = 0.0;
    for (std::int32_t t = 0; t < surface.triangle.rows(); ++t) {
      const std::int32_t a = surface.triangle(t, 0);
      const std::int32_t b = surface.triangle(t, 1);
      const std::int32_t c = surface.triangle(t, 2);
      if (!reaches(a) || !reaches(b) || !reaches(c)) {
        continue;
      }
      const Eigen::Vector3d ab = surface.position_m.row(b) - surface.position_m.row(a);
      const Eigen::Vector3d ac = surface.position_m.row(c) - surface.position_m.row(a);
      sum += ab.cross(ac).norm();
      triangle.push_back(t);
      area_until.push_back(sum);
    }
  }

  [[nodiscard]] std::int32_t at_share(double share) const {
    const auto found = std::upper_bound(area_until.begin(), area_until.end(),
                                        share * area_until.back());
    const auto last = static_cast<std::ptrdiff_t>(triangle.size()) - 1;
    return triangle[static_cast<std::size_t>(
        std::min(found - area_until.begin(), last))];
  }
};

// Turk, "Generating random points in triangles", Graphics Gems, 1990. Those near an
// edge are on it, but not near its ends.
Eigen::Vector3d area_coordinates(double u, double v) {
  constexpr double kNear = 0.1;
  const double root = std::sqrt(u);
  Eigen::Vector3d b{1.0 - root, root * (1.0 - v), root * v};
  int least = 0;
  if (b.minCoeff(&least) >= kNear) {
    return b;
  }
  int most = 0;
  (void)b.maxCoeff(&most);
  const int middle = 3 - most - least;
  b[least] = 0.0;
  b[middle] = std::max(kNear, b[middle] / (b[middle] + b[most]));
  b[most] = 1.0 - b[middle];
  return b;
}

WorkUnit check_at(const SurfaceMesh& surface, const OpenSurface& open,
                  std::uint64_t i) {
  WorkUnit check{.is_check = true, .vertex = {}};
  SurfacePoint& place = check.place;
  place.triangle = open.at_share(evenly(3 * i));
  place.area_coordinate = area_coordinates(evenly(3 * i + 1), evenly(3 * i + 2));
  int most = 0;
  (void)place.area_coordinate.maxCoeff(&most);
  check.vertex = {surface.triangle(place.triangle, most)};
  return check;
}

std::vector<WorkUnit> checks_at_vertices(std::span<const std::int32_t> vertices,
                                         std::size_t count) {
  std::vector<std::int32_t> order(vertices.begin(), vertices.end());
  count = std::min(order.size(), count);
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count),
                    order.end(), [](std::int32_t a, std::int32_t b) {
                      return scrambled(static_cast<std::uint64_t>(a)) <
                             scrambled(static_cast<std::uint64_t>(b));
                    });
  std::vector<WorkUnit> checks;
  for (std::size_t i = 0; i < count; ++i) {
    checks.push_back({.is_check = true, .vertex = {order[i]}});
  }
  return checks;
}

std::vector<WorkUnit> checks_of(const Scene& scene, const BodySource& body,
                                std::span<const std::int32_t> vertices) {
  const auto count = static_cast<std::size_t>(scene.accuracy.verify);
  const OpenSurface open(body.surface, vertices);
  if (open.triangle.empty() || scene.cutout) {
    return checks_at_vertices(vertices, count);
  }
  std::vector<WorkUnit> checks;
  for (std::size_t i = 0; i < count; ++i) {
    checks.push_back(check_at(body.surface, open, i));
  }
  return checks;
}

// Needles were pressed as balls.
void sharpen_needles(const Scene& scene, const BodySource& body,
                     std::vector<WorkUnitNode>& nodes) {
  for (WorkUnitNode& node : nodes) {
    const auto tool = static_cast<std::size_t>(node.tool);
    if (tool >= scene.tool_needle.size()) {
      continue;
    }
    if (const auto& needle = scene.tool_needle[tool]) {
      sharpen(tissue_at(body, node.vertex),
              {needle->radius_m, 0.5 * needle->tip_angle_rad}, needle->press_radius_m,
              is_nonlinear(scene, body), node.response);
      node.response.contact = {};  // it was the ball's
      fail_if_broken(node);
    }
  }
}

}  // namespace

double check_times_finer(const PressStrategy& strategy, const SurfacePoint& place) {
  if (!strategy.nonlinear) {
    return kLinearCheckTimesFiner;
  }
  return place.triangle < 0 ? kNonlinearCheckTimesFiner : 1.0;
}

std::size_t expected_samples(std::size_t vertices, double force_relative) {
  constexpr double kShare = 0.35;
  constexpr double kTightShare = 0.5;  // a guess: no build to so little was counted
  if (is_small(vertices, force_relative)) {
    return vertices;
  }
  const double share = force_relative < kTightBudget ? kTightShare : kShare;
  return static_cast<std::size_t>(std::lround(share * static_cast<double>(vertices)));
}

std::vector<WorkUnit> units_of(const Scene& scene, const BodySource& body,
                               std::span<const std::int32_t> vertices) {
  std::vector<WorkUnit> units;
  for (auto& group :
       in_neighbourhoods(body.surface, vertices, cluster_size(vertices.size()))) {
    units.push_back({static_cast<std::int64_t>(units.size()), false, std::move(group)});
  }
  for (WorkUnit& check : checks_of(scene, body, vertices)) {
    check.index = static_cast<std::int64_t>(units.size());
    units.push_back(std::move(check));
  }
  return units;
}

WorkUnitOutcome failed_unit(const WorkUnit& unit, std::size_t tools,
                            const std::string& reason) {
  WorkUnitOutcome outcome{
      .index = unit.index, .is_check = unit.is_check, .node = {}, .place = unit.place};
  for (std::size_t t = 0; t < tools; ++t) {
    for (const std::int32_t vertex : unit.vertex) {
      outcome.node.push_back({.tool = static_cast<std::int32_t>(t),
                              .vertex = vertex,
                              .response = {},
                              .failure = reason});
      fail_if_broken(outcome.node.back());
    }
  }
  return outcome;
}

WorkUnitOutcome solve_unit(const Scene& scene, const BodySource& body,
                           const PressStrategy& strategy, const SceneSolver& solver,
                           const WorkUnit& unit, bool solve_all) {
  if (unit.is_check) {
    WorkUnitOutcome check = solve_check(scene, body, strategy, solver, unit);
    sharpen_needles(scene, body, check.node);
    return check;
  }
  WorkUnitOutcome outcome{.index = unit.index, .is_check = false, .node = {}};
  for (std::size_t t = 0; t < body.tool.size(); ++t) {
    Cluster cluster(scene, body, solver, body.tool[t], unit.vertex);
    const bool own_meshes = !strategy.shared_mesh && !strategy.cut_out;
    if (strategy.linear_is_full) {
      cluster.solve_linear();
      cluster.keep_linear_within_budget(strategy.graded);
    } else if (solve_all) {
      if (!own_meshes) {  // else linear ones cost about as much
        cluster.solve_linear();
      }
      cluster.solve_all();
    } else if (own_meshes && is_small(unit.vertex.size(), scene.force_relative)) {
      cluster.solve_few_first();
    } else {
      cluster.solve_linear();
      cluster.solve_within_budget();
    }
    cluster.answer(static_cast<std::int32_t>(t), outcome.node);
  }
  sharpen_needles(scene, body, outcome.node);
  return outcome;
}

}  // namespace palpate
