#include "precompute/press/cluster.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "formats/base/reproducible.h"
#include "formats/database/error_calibration.h"
#include "precompute/body/mesh_grading.h"
#include "precompute/contact/indentation_response.h"
#include "precompute/contact/lateral_state.h"
#include "precompute/process/fault_point.h"

namespace palpate {
namespace {

// Vertices that face so many radians apart, or are exp(0.3) times as stiff, are of
// different kinds.
constexpr double kOtherKind = 0.3;

}  // namespace

bool keeps_budget(std::span<const double> expected, std::size_t known, double budget) {
  if (known < kChecksToCalibrate) {
    return kExpectedErrorFactor * *std::max_element(expected.begin(), expected.end()) <=
           budget;
  }
  // Expected number of nodes beyond the budget, for normal errors of standard deviation
  // error / kExpectedDeviations: P(|e| > budget) = erfc(budget / (sqrt(2) sd)).
  double beyond = 0.0;
  for (const double error : expected) {
    beyond +=
        reproducible::erfc(budget * kExpectedDeviations / (std::sqrt(2.0) * error));
  }
  return beyond <= (1.0 - kErrorCoverage) * static_cast<double>(expected.size());
}

Cluster::Cluster(const Scene& scene, const BodySource& body, const SceneSolver& solver,
                 const SharedTool& tool, std::span<const std::int32_t> vertices)
    : scene_(scene),
      body_(body),
      solver_(solver),
      tool_(tool),
      vertex_(vertices),
      linear_(vertices.size()),
      full_(vertices.size()),
      field_(no_ratios()) {}

RatioField Cluster::no_ratios() const {
  return {body_.surface, body_.normal, contact_focus(scene_, body_).contact_m};
}

void Cluster::keep_linear_within_budget(bool graded) {
  std::copy(linear_.begin(), linear_.end(), full_.begin());
  Places outside;
  for (std::size_t i = 0; graded && i < full_.size(); ++i) {
    if (!full_[i]->patch.empty() && is_outside_budget(*full_[i])) {
      outside.push_back(i);
    }
  }
  for (PressedNode& node : solver_.refined(tool_, vertices_at(outside))) {
    PressedNode& kept = *full_[index_of(node.vertex)];
    Attempt& last = kept.tried[last_taken(kept.tried)];
    Attempt& finest = node.tried[last_taken(node.tried)];
    const NodeResponse coarse = response_of(kept);
    // mesh_error() extrapolates from two meshes of a node's own, one twice as fine
    // (kFinerStep).
    const bool twice_as_fine =
        solver_.shared() == nullptr && !last.outcome.late &&
        finest.recipe.times_finer == kFinerStep * last.recipe.times_finer;
    last.outcome.error_relative = coarse.error_relative;
    finest.outcome.error_relative = estimate(node);
    if (take_if_better(kept, Reason::kOutsideBudget, std::move(node)) &&
        twice_as_fine) {
      kept.indentation.mesh_error =
          mesh_error(coarse, response_of(kept), kept.path.outward);
    }
  }
}

bool Cluster::is_outside_budget(const PressedNode& node) const {
  return kExpectedErrorFactor * estimate(node) > scene_.force_relative ||
         touches_late(node);
}

NodeResponse Cluster::response_of(const PressedNode& node) const {
  return to_response(node.indentation, node.path, scene_.force_relative);
}

double Cluster::estimate(const PressedNode& node) const {
  return response_of(node).error_relative;
}

std::vector<std::int32_t> Cluster::vertices_at(const Places& which) const {
  std::vector<std::int32_t> vertices;
  vertices.reserve(which.size());
  for (const std::size_t i : which) {
    vertices.push_back(vertex_[i]);
  }
  std::sort(vertices.begin(), vertices.end());
  return vertices;
}

void Cluster::solve_within_budget() {
  solve(only_by_solving());
  solve(farthest(kFirstSamples, {}));
  solve_kinds_until_within_budget();
}

void Cluster::solve_few_first() {
  solve(far_apart(kFirstSamples));
  if (!few_predict_each_other()) {
    solve(unsolved());
    return;
  }
  solve_linear();
  for (std::size_t i = 0; i < full_.size(); ++i) {
    if (full_[i] && is_like_others(i)) {
      take_ratio(i, *full_[i]);
    }
  }
  solve(only_by_solving());
  solve_kinds_until_within_budget();
}

// Whether the ratio of each solved vertex follows from the others', within the budget.
bool Cluster::few_predict_each_other() const {
  RatioField trial = no_ratios();
  for (const auto& node : full_) {
    if (!node) {
      continue;
    }
    auto ratio = path_ratio(node->indentation, node->linear);
    if (!node->failure.empty() || !ratio) {
      return false;
    }
    trial.add(node->vertex, node->linear, std::move(ratio));
  }
  const std::vector<double> error = RatioModel(trial).left_out_errors();
  return kExpectedErrorFactor * *std::max_element(error.begin(), error.end()) <
         scene_.force_relative;
}

// Ratios that are alike say nothing about a kind of place that nobody has solved, like
// an edge between faces.
void Cluster::solve_kinds_until_within_budget() {
  solve(other_kinds());
  while (true) {
    const RatioModel ratios(field_);
    std::vector<double> error(vertex_.size(), 0.0);
    for (std::size_t i = 0; i < vertex_.size(); ++i) {
      if (!full_[i] && is_like_others(i)) {
        error[i] = expected_error(i, ratios);
      }
    }
    if (keeps_budget(error, field_.size(), scene_.force_relative)) {
      return;
    }
    const Places more =
        farthest(std::max(kMoreSamples, field_.size() / kKnownPerSample), error);
    if (more.empty()) {
      return;
    }
    solve(more);
  }
}

void Cluster::answer(std::int32_t tool, std::vector<WorkUnitNode>& nodes) const {
  const RatioModel ratios(field_);
  for (std::size_t i = 0; i < vertex_.size(); ++i) {
    WorkUnitNode node{.tool = tool, .vertex = vertex_[i]};
    const PressedNode& press = full_[i] ? *full_[i] : linear_[i];
    node.failure = press.failure;
    node.reaches_elsewhere = press.indentation.reaches_elsewhere;
    bool ends_early = press.indentation.ends_early;
    // Solved, predicted by kriging, or without an answer though the tool touches.
    if (full_[i]) {
      node.history = history_text(press.tried);
      node.response = response_of(press);
    } else if (is_like_others(i) && field_.size() > 0) {
      node.response = interpolated(i, ratios, ends_early);
    } else if (touches(i)) {
      node.failure = "no neighbour was solved that it could be interpolated from";
    }
    if (ends_early && node.failure.empty() && !node.response.force_n.empty()) {
      node.failure = fmt::format(
          "it ends at {:.4g} N, where the linear press has passed {} times force_max_n",
          node.response.force_n.back(), kLinearForceTimes);
    }
    if (ends_at_support(scene_, press) && !node.response.depth_m.empty()) {
      node.response.flags =
          static_cast<std::uint8_t>(node.response.flags | kTruncatedPath);
    }
    fail_if_broken(node);
    nodes.push_back(std::move(node));
  }
}

bool Cluster::touches(std::size_t i) const {
  return linear_[i].indentation.sample.size() > 1;
}

// Whether ratios of others may scale the linear press.
bool Cluster::is_like_others(std::size_t i) const {
  return is_predictor(linear_[i].indentation) && !touches_late(linear_[i]);
}

Cluster::Places Cluster::unsolved() const {
  Places which;
  for (std::size_t i = 0; i < full_.size(); ++i) {
    if (!full_[i]) {
      which.push_back(i);
    }
  }
  return which;
}

// Vertices about whose response neither the linear press nor neighbours say anything.
Cluster::Places Cluster::only_by_solving() const {
  Places which;
  for (const std::size_t i : unsolved()) {
    if (!linear_[i].patch.empty() && !is_like_others(i)) {
      which.push_back(i);
    }
  }
  return which;
}

// The first vertex, and each time the farthest from those before.
Cluster::Places Cluster::far_apart(std::size_t count) const {
  Places chosen{0};
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

// Where errors are given, distances count in proportion to them.
Cluster::Places Cluster::farthest(std::size_t count,
                                  std::span<const double> error) const {
  return spread(
      count,
      [&](std::size_t i, std::size_t j) {
        return field_.distance_m(place(i), place(j));
      },
      [&](std::size_t i, double apart_m) {
        return apart_m * (error.empty() ? 1.0 : error[i]);
      });
}

Cluster::Places Cluster::other_kinds() const {
  return spread(
      kOtherKinds,
      [&](std::size_t i, std::size_t j) {
        return field_.unlikeness(place(i), place(j));
      },
      [](std::size_t, double unlike) {
        return unlike > kOtherKind ? unlike : 0.0;
      });
}

// Vertices that touch and are not solved yet, each the one that is worth most for its
// distance from those solved or chosen, as long as one is worth anything.
Cluster::Places Cluster::spread(
    std::size_t count, const std::function<double(std::size_t, std::size_t)>& apart,
    const std::function<double(std::size_t, double)>& worth) const {
  // Farthest-point sampling: `distance` is that to the nearest vertex solved or chosen.
  std::vector<double> distance(vertex_.size(), std::numeric_limits<double>::infinity());
  const auto take = [&](std::size_t chosen) {
    for (std::size_t i = 0; i < vertex_.size(); ++i) {
      if (is_like_others(i) && is_like_others(chosen)) {
        distance[i] = std::min(distance[i], apart(i, chosen));
      }
    }
  };
  for (std::size_t i = 0; i < vertex_.size(); ++i) {
    if (full_[i]) {
      take(i);
    }
  }
  Places chosen;
  while (chosen.size() < count) {
    std::optional<std::size_t> best;
    double most = 0.0;
    for (std::size_t i = 0; i < vertex_.size(); ++i) {
      if (!full_[i] && is_like_others(i) && worth(i, distance[i]) > most) {
        best = i;
        most = worth(i, distance[i]);
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

// Infinite where only a solve can tell.
double Cluster::expected_error(std::size_t i, const RatioModel& ratios) const {
  return field_.size() < 2 ? std::numeric_limits<double>::infinity()
                           : ratios.error_at(vertex_[i], linear_[i].indentation);
}

// What the tangent made of the lateral stiffness at the nearest solved vertex [-].
double Cluster::nearest_tangent(std::size_t i) const {
  double least_m = std::numeric_limits<double>::infinity();
  double times = 0.0;
  for (std::size_t j = 0; j < full_.size(); ++j) {
    if (!full_[j] || full_[j]->indentation.contact.empty()) {
      continue;
    }
    const double apart_m = (body_.surface.position_m.row(vertex_[i]) -
                            body_.surface.position_m.row(vertex_[j]))
                               .norm();
    if (apart_m < least_m) {
      least_m = apart_m;
      times = full_[j]->indentation.contact.back().by_tangent;
    }
  }
  return times;
}

NodeResponse Cluster::interpolated(std::size_t i, const RatioModel& ratios,
                                   bool& ends_early) const {
  const Indentation& linear = linear_[i].indentation;
  Indentation path =
      scaled(linear, ratios.at(vertex_[i], linear), scene_.reach.force_max_n);
  take_tangent(path, path.sample.back().penetration_m, nearest_tangent(i));
  ends_early = path.ends_early;
  NodeResponse response = to_response(path, linear_[i].path, scene_.force_relative);
  response.origin = ResponseOrigin::kInterpolated;
  response.error_relative =
      std::hypot(response.error_relative, ratios.error_at(vertex_[i], linear));
  fault_point(FaultPlace::kInterpolation, vertex_[i], response.force_n);
  response.flags = static_cast<std::uint8_t>(response.flags & ~kCoarseContact);
  return response;
}

void Cluster::solve(const Places& which) {
  for (PressedNode& node : solver_.full(tool_, vertices_at(which))) {
    const std::size_t i = index_of(node.vertex);
    if (node.failure.empty() && is_like_others(i)) {
      take_ratio(i, node);
    }
    full_[i] = std::move(node);
  }
}

std::size_t Cluster::index_of(std::int32_t vertex) const {
  return static_cast<std::size_t>(
      std::lower_bound(vertex_.begin(), vertex_.end(), vertex) - vertex_.begin());
}

// What a full press says about its neighbours: the law's share alone, both on one mesh.
void Cluster::take_ratio(std::size_t i, const PressedNode& node) {
  const Indentation& linear = linear_[i].indentation;
  auto ratio = path_ratio(node.indentation, node.linear);
  if (ratio) {
    fault_point(FaultPlace::kRatio, node.vertex,
                {ratio->force.data(), static_cast<std::size_t>(ratio->force.size())});
    if (!ratio->force.allFinite()) {
      ratio.reset();  // it would spoil its neighbours' means
    }
  }
  field_.add(node.vertex, linear, std::move(ratio));
}

}  // namespace palpate
