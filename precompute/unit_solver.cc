#include "precompute/unit_solver.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "precompute/fault_point.h"
#include "precompute/path_ratio.h"

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

std::size_t territory_size(std::size_t vertices) {
  return std::clamp<std::size_t>((vertices + 3) / 4, 128, 512);
}

// The vertices of a territory, each with its cheap press and, where it is solved, its
// good one.
class Territory {
 public:
  Territory(const Scene& scene, const BodySource& body, const SceneSolver& solver,
            const SharedTool& tool, const Unit& unit)
      : scene_(scene),
        body_(body),
        solver_(solver),
        tool_(tool),
        vertex_(unit.vertex),
        cheap_(unit.vertex.size()),
        good_(unit.vertex.size()),
        field_(body.surface, body.normal, contact_focus(scene, body).contact_m) {}

  void press_cheap() { cheap_ = solver_.cheap(tool_, vertex_); }

  void solve_all() { solve(unsolved()); }

  // Without cheap presses: for those that cost about as much as good ones and are
  // wanted only where others can be interpolated.
  void solve_all_alone() { solve_alone(unsolved()); }

  // A few good presses tell whether the others can be interpolated from them; only then
  // are cheap ones worth their time.
  void solve_few_first() {
    solve_alone(far_apart(kFirstSamples));
    RatioField trial(body_.surface, body_.normal,
                     contact_focus(scene_, body_).contact_m);
    bool alike = true;
    for (const auto& node : good_) {
      if (node) {
        auto ratio = path_ratio(node->indentation, node->linear);
        alike = alike && node->failure.empty() && ratio;
        if (alike) {
          trial.add(node->vertex, node->linear, std::move(ratio));
        }
      }
    }
    const std::vector<double> error = trial.leave_one_out();
    if (!alike ||
        !(*std::max_element(error.begin(), error.end()) < scene_.force_relative)) {
      solve_alone(unsolved());
      return;
    }
    press_cheap();
    for (std::size_t i = 0; i < good_.size(); ++i) {
      if (good_[i] && is_like_others(i)) {
        take_ratio(i, *good_[i]);
      }
    }
    solve(only_by_solving());
    solve_until_within_budget();
  }

  void solve_within_budget() {
    solve(only_by_solving());
    solve(farthest(kFirstSamples, {}));
    solve_until_within_budget();
  }

  void solve_until_within_budget() {
    while (true) {
      const std::vector<double> left_out = field_.leave_one_out();
      std::vector<double> error(vertex_.size(), 0.0);
      for (std::size_t i = 0; i < vertex_.size(); ++i) {
        if (!good_[i] && is_like_others(i)) {
          error[i] = expected_error(i, left_out);
        }
      }
      const double worst = *std::max_element(error.begin(), error.end());
      if (!(worst > scene_.force_relative)) {
        return;
      }
      const std::vector<std::size_t> more = farthest(kMoreSamples, error);
      if (more.empty()) {
        return;
      }
      solve(more);
    }
  }

  void answer(std::int32_t tool, std::vector<UnitNode>& nodes) const {
    const std::vector<double> left_out = field_.leave_one_out();
    for (std::size_t i = 0; i < vertex_.size(); ++i) {
      UnitNode node{.tool = tool, .vertex = vertex_[i]};
      if (good_[i]) {
        node.response =
            to_response(good_[i]->indentation, good_[i]->path, scene_.force_relative);
        node.failure = good_[i]->failure;
        node.reaches_elsewhere = good_[i]->indentation.reaches_elsewhere;
      } else {
        node.failure = cheap_[i].failure;
        node.reaches_elsewhere = cheap_[i].indentation.reaches_elsewhere;
        if (is_like_others(i) && field_.size() > 0) {
          node.response = interpolated(i, left_out);
        } else if (touches(i)) {
          node.failure = "no neighbour was solved that it could be interpolated from";
        }
      }
      fail_if_broken(node);
      nodes.push_back(std::move(node));
    }
  }

  // Where cheap presses are of the same kind as good ones: those that their own
  // estimate finds far outside the budget are done again.
  void keep_cheap_within_budget(bool again) {
    std::vector<std::size_t> outside;
    for (std::size_t i = 0; i < vertex_.size(); ++i) {
      const double error =
          to_response(cheap_[i].indentation, cheap_[i].path, scene_.force_relative)
              .error_relative;
      if (again && !cheap_[i].patch.empty() &&
          (error > scene_.force_relative || touches_late(cheap_[i]))) {
        outside.push_back(i);
      } else {
        good_[i] = cheap_[i];
      }
    }
    solve(outside);
  }

 private:
  [[nodiscard]] bool touches(std::size_t i) const {
    return cheap_[i].indentation.sample.size() > 1;
  }

  // Whether ratios of others may scale the cheap press.
  [[nodiscard]] bool is_like_others(std::size_t i) const {
    return is_guide(cheap_[i].indentation) && !touches_late(cheap_[i]);
  }

  // Vertices about whose response neither the cheap press nor neighbours say anything.
  [[nodiscard]] std::vector<std::size_t> only_by_solving() const {
    std::vector<std::size_t> which;
    for (std::size_t i = 0; i < vertex_.size(); ++i) {
      if (!good_[i] && !cheap_[i].patch.empty() && !is_like_others(i)) {
        which.push_back(i);
      }
    }
    return which;
  }

  // Infinite where only a solve can tell.
  [[nodiscard]] double expected_error(std::size_t i,
                                      std::span<const double> left_out) const {
    return field_.size() < 2
               ? std::numeric_limits<double>::infinity()
               : field_.error_at(vertex_[i], cheap_[i].indentation, left_out);
  }

  [[nodiscard]] NodeResponse interpolated(std::size_t i,
                                          std::span<const double> left_out) const {
    const Indentation& cheap = cheap_[i].indentation;
    const Indentation path =
        scaled(cheap, field_.at(vertex_[i], cheap), scene_.reach.force_max_n);
    NodeResponse response = to_response(path, cheap_[i].path, scene_.force_relative);
    response.origin = ResponseOrigin::kInterpolated;
    response.error_relative = std::hypot(response.error_relative,
                                         field_.error_at(vertex_[i], cheap, left_out));
    fault_point(FaultPlace::kInterpolation, vertex_[i], response.force_n);
    response.flags = static_cast<std::uint8_t>(
        (response.flags & ~(kErrorOverBudget | kCoarseContact)) |
        (response.error_relative > scene_.force_relative || cheap.reaches_elsewhere
             ? kErrorOverBudget
             : 0));
    return response;
  }

  void solve(const std::vector<std::size_t>& which) {
    std::vector<std::int32_t> vertices;
    vertices.reserve(which.size());
    for (const std::size_t i : which) {
      vertices.push_back(vertex_[i]);
    }
    std::sort(vertices.begin(), vertices.end());
    for (PressedNode& node : solver_.good(tool_, vertices)) {
      const std::size_t i = index_of(node.vertex);
      if (node.failure.empty() && is_like_others(i)) {
        take_ratio(i, node);
      }
      good_[i] = std::move(node);
    }
  }

  [[nodiscard]] std::vector<std::size_t> unsolved() const {
    std::vector<std::size_t> which;
    for (std::size_t i = 0; i < good_.size(); ++i) {
      if (!good_[i]) {
        which.push_back(i);
      }
    }
    return which;
  }

  void solve_alone(const std::vector<std::size_t>& which) {
    std::vector<std::int32_t> vertices;
    for (const std::size_t i : which) {
      vertices.push_back(vertex_[i]);
    }
    std::sort(vertices.begin(), vertices.end());
    for (PressedNode& node : solver_.good(tool_, vertices)) {
      good_[index_of(node.vertex)] = std::move(node);
    }
  }

  [[nodiscard]] std::size_t index_of(std::int32_t vertex) const {
    return static_cast<std::size_t>(
        std::lower_bound(vertex_.begin(), vertex_.end(), vertex) - vertex_.begin());
  }

  // The first vertex, and each time the farthest from those before.
  [[nodiscard]] std::vector<std::size_t> far_apart(std::size_t count) const {
    std::vector<std::size_t> chosen{0};
    const auto apart_m = [&](std::size_t i) {
      double least = std::numeric_limits<double>::infinity();
      for (const std::size_t c : chosen) {
        least = std::min(least, (body_.surface.position_m.row(vertex_[i]) -
                                 body_.surface.position_m.row(vertex_[c]))
                                    .norm());
      }
      return least;
    };
    while (chosen.size() < std::min(count, vertex_.size())) {
      std::size_t best = 0;
      for (std::size_t i = 1; i < vertex_.size(); ++i) {
        best = apart_m(i) > apart_m(best) ? i : best;
      }
      chosen.push_back(best);
    }
    return chosen;
  }

  // What a good press says about its neighbours; its own path becomes the cheap one
  // times the ratio, which is the good one on the cheap one's mesh. A press without a
  // ratio stays as it is.
  void take_ratio(std::size_t i, PressedNode& node) {
    const Indentation& cheap = cheap_[i].indentation;
    auto ratio = path_ratio(node.indentation, node.linear);
    if (ratio) {
      fault_point(FaultPlace::kRatio, node.vertex,
                  {ratio->force.data(), static_cast<std::size_t>(ratio->force.size())});
      node.indentation = scaled(cheap, *ratio, scene_.reach.force_max_n);
      drop_if_broken(node, "ratio of nonlinear and linear force");
    }
    if (node.failure.empty()) {
      field_.add(node.vertex, cheap, std::move(ratio));
    }
  }

  // Vertices that touch and are not solved yet, each the farthest from those solved or
  // chosen; where errors are given, distances count in proportion to them.
  [[nodiscard]] std::vector<std::size_t> farthest(std::size_t count,
                                                  std::span<const double> error) const {
    std::vector<double> distance(vertex_.size(),
                                 std::numeric_limits<double>::infinity());
    const auto take = [&](std::size_t chosen) {
      for (std::size_t i = 0; i < vertex_.size(); ++i) {
        if (is_like_others(i) && is_like_others(chosen)) {
          distance[i] =
              std::min(distance[i],
                       field_.distance_m(vertex_[i], cheap_[i].indentation,
                                         vertex_[chosen], cheap_[chosen].indentation));
        }
      }
    };
    for (std::size_t i = 0; i < vertex_.size(); ++i) {
      if (good_[i]) {
        take(i);
      }
    }
    std::vector<std::size_t> chosen;
    while (chosen.size() < count) {
      std::optional<std::size_t> best;
      double most = 0.0;
      for (std::size_t i = 0; i < vertex_.size(); ++i) {
        const double worth = distance[i] * (error.empty() ? 1.0 : error[i]);
        if (!good_[i] && is_like_others(i) && worth > most) {
          best = i;
          most = worth;
        }
      }
      if (!best) {
        break;
      }
      chosen.push_back(*best);
      take(*best);
    }
    return chosen;
  }

  const Scene& scene_;
  const BodySource& body_;
  const SceneSolver& solver_;
  const SharedTool& tool_;
  const std::vector<std::int32_t>& vertex_;
  std::vector<PressedNode> cheap_;
  std::vector<std::optional<PressedNode>> good_;
  RatioField field_;
};

UnitOutcome solve_check(const Scene& scene, const BodySource& body,
                        const SceneSolver& solver, const Unit& unit) {
  UnitOutcome outcome{.index = unit.index, .is_check = true, .node = {}};
  for (std::size_t t = 0; t < body.tool.size(); ++t) {
    for (const PressedNode& node :
         solver.good(body.tool[t], unit.vertex, kCheckTimesFiner)) {
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

std::size_t expected_samples(double force_relative) {
  return kFirstSamples + kMoreSamples * (force_relative < 0.03 ? 12 : 6);
}

std::vector<Unit> units_of(const Scene& scene, const BodySource& body,
                           std::span<const std::int32_t> vertices) {
  std::vector<Unit> units;
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

UnitOutcome failed_unit(const Unit& unit, std::size_t tools,
                        const std::string& reason) {
  UnitOutcome outcome{.index = unit.index, .is_check = unit.is_check, .node = {}};
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

UnitOutcome solve_unit(const Scene& scene, const BodySource& body,
                       const Approach& approach, const SceneSolver& solver,
                       const Unit& unit, bool solve_all) {
  if (unit.is_check) {
    return solve_check(scene, body, solver, unit);
  }
  UnitOutcome outcome{.index = unit.index, .is_check = false, .node = {}};
  for (std::size_t t = 0; t < body.tool.size(); ++t) {
    Territory territory(scene, body, solver, body.tool[t], unit);
    const bool own_meshes = !approach.shared_mesh && !approach.cut_out;
    if (approach.cheap_is_good) {
      territory.press_cheap();
      territory.keep_cheap_within_budget(approach.graded && approach.shared_mesh);
    } else if (solve_all && own_meshes) {
      territory.solve_all_alone();
    } else if (solve_all) {
      territory.press_cheap();
      territory.solve_all();
    } else if (own_meshes &&
               unit.vertex.size() <= expected_samples(scene.force_relative)) {
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
