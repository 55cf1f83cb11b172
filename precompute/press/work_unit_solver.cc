#include "precompute/press/work_unit_solver.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "precompute/contact/indentation_response.h"
#include "precompute/press/territory.h"

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

constexpr double kTightBudget = 0.03;  // [-] of force

// Of so few vertices most are probably solved: not worth cheap presses of all, unless a
// few good ones say otherwise.
bool is_small(std::size_t vertices, double force_relative) {
  return vertices <= (force_relative < kTightBudget ? 76 : 52);
}

std::size_t territory_size(std::size_t vertices) {
  return std::clamp<std::size_t>((vertices + 3) / 4, 128, 512);
}

WorkUnitOutcome solve_check(const Scene& scene, const BodySource& body,
                            const PressStrategy& strategy, const SceneSolver& solver,
                            const WorkUnit& unit) {
  const double times_finer =
      strategy.nonlinear ? kNonlinearCheckTimesFiner : kLinearCheckTimesFiner;
  WorkUnitOutcome outcome{.index = unit.index, .is_check = true, .node = {}};
  for (std::size_t t = 0; t < body.tool.size(); ++t) {
    for (const PressedNode& node :
         solver.better(body.tool[t], unit.vertex, times_finer)) {
      outcome.node.push_back(
          {.tool = static_cast<std::int32_t>(t),
           .vertex = node.vertex,
           .response = to_response(node.indentation, node.path, scene.force_relative),
           .failure = node.failure});
      fail_if_broken(outcome.node.back());
    }
  }
  return outcome;
}

}  // namespace

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
       in_neighbourhoods(body.surface, vertices, territory_size(vertices.size()))) {
    units.push_back({static_cast<std::int64_t>(units.size()), false, std::move(group)});
  }
  std::vector<std::int32_t> order(vertices.begin(), vertices.end());
  const auto checks =
      std::min(order.size(), static_cast<std::size_t>(scene.accuracy.verify));
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(checks),
                    order.end(), [](std::int32_t a, std::int32_t b) {
                      return scrambled(static_cast<std::uint64_t>(a)) <
                             scrambled(static_cast<std::uint64_t>(b));
                    });
  for (std::size_t i = 0; i < checks; ++i) {
    units.push_back({static_cast<std::int64_t>(units.size()), true, {order[i]}});
  }
  return units;
}

WorkUnitOutcome failed_unit(const WorkUnit& unit, std::size_t tools,
                            const std::string& reason) {
  WorkUnitOutcome outcome{.index = unit.index, .is_check = unit.is_check, .node = {}};
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
    return solve_check(scene, body, strategy, solver, unit);
  }
  WorkUnitOutcome outcome{.index = unit.index, .is_check = false, .node = {}};
  for (std::size_t t = 0; t < body.tool.size(); ++t) {
    Territory territory(scene, body, solver, body.tool[t], unit.vertex);
    const bool own_meshes = !strategy.shared_mesh && !strategy.cut_out;
    if (strategy.cheap_is_good) {
      territory.press_cheap();
      territory.keep_cheap_within_budget(strategy.graded);
    } else if (solve_all) {
      if (!own_meshes) {  // else cheap ones cost about as much
        territory.press_cheap();
      }
      territory.solve_all();
    } else if (own_meshes && is_small(unit.vertex.size(), scene.force_relative)) {
      territory.solve_few_first();
    } else {
      territory.press_cheap();
      territory.solve_within_budget();
    }
    territory.answer(static_cast<std::int32_t>(t), outcome.node);
  }
  return outcome;
}

}  // namespace palpate
