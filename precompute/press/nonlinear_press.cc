#include "precompute/press/nonlinear_press.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "formats/response/force_difference.h"
#include "precompute/contact/contact_gap.h"
#include "precompute/contact/lateral_state.h"
#include "precompute/fem/batched_solves.h"
#include "precompute/press/interpolation_error.h"
#include "precompute/press/relative_correction.h"
#include "precompute/press/response_ratio.h"
#include "precompute/process/fault_point.h"
#include "precompute/process/supervised_build.h"

namespace palpate {
namespace {

constexpr std::size_t kLockStep = 32;

// Depths that are solved nonlinear, as shares of a path's samples.
constexpr std::array kFewShares{0.4, 0.65, 0.85, 1.0};
// Those of a press that tells what correcting between them makes. The second may not be
// too far for a prediction from the first.
constexpr std::array kBetweenShares{0.3, 0.525, 0.75, 0.925, 1.0};

// Forces grow with this power of the depth (Hertz), or nearly so.
constexpr double kForcePower = 1.5;
// [-] Of the budget, and of one of 5 % at most: what springs of the contact may cost.
constexpr double kGiveShare = 0.05;

// Samples of a path that are solved, however easy it is to follow.
std::vector<std::size_t> solved_samples(std::size_t samples, SolvedDepths depths) {
  std::vector<std::size_t> at;
  if (depths == SolvedDepths::kEvery) {
    for (std::size_t k = 1; k < samples; ++k) {
      at.push_back(k);
    }
    return at;
  }
  const auto last = static_cast<double>(samples - 1);
  for (const double share : depths == SolvedDepths::kFew
                                ? std::span<const double>(kFewShares)
                                : std::span<const double>(kBetweenShares)) {
    const auto k =
        std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(share * last)));
    if (at.empty() || k > at.back()) {
      at.push_back(k);
    }
  }
  return at;
}

// A step for each sample but the first, where the tool touches.
std::vector<PressStep> steps_of(const PressedNode& node, SolvedDepths depths) {
  const auto& path = node.indentation.sample;
  const std::vector<std::size_t> solved = solved_samples(path.size(), depths);
  std::vector<PressStep> steps;
  for (std::size_t k = 1; k < path.size(); ++k) {
    steps.push_back(
        {.penetration_m = path[k].penetration_m,
         .tool = tool_at(node.path, path[k].penetration_m),
         .linear_pressure_n = path[k].pressure_n,
         .only_if_hard = !std::binary_search(solved.begin(), solved.end(), k)});
  }
  return steps;
}

double radius_of(const NonlinearSample& solved) {
  return std::sqrt(solved.contact_area_m2 / std::numbers::pi);
}

std::size_t sample_of(const NonlinearSample& solved) {
  return solved.step + 1;
}

void spoil(const PressedNode& node, NonlinearIndentation& result) {
  for (NonlinearSample& sample : result.sample) {
    fault_point(FaultPlace::kCorrection, node.vertex,
                {sample.force_n.data(), std::size_t{3}});
  }
}

// Ends the path where its force passes the largest that the scene wants. A body much
// softer than its linear one may not come so far.
void cap_force(PressedNode& node, double force_max_n) {
  auto& samples = node.indentation.sample;
  const bool linear_ended = std::exchange(node.indentation.force_capped, false);
  const auto past = std::find_if(samples.begin(), samples.end(), [&](const auto& s) {
    return s.force_n.norm() > force_max_n;
  });
  if (past != samples.end()) {
    samples.erase(past + 1, samples.end());
    node.indentation.force_capped = true;
  }
  node.indentation.ends_early =
      linear_ended && !node.indentation.force_capped && node.failure.empty();
}

// Springs that deflect by g are felt as a tool that is g off its place.
double give_error(double touch_m, double from_m, const NonlinearIndentation& result) {
  double largest = 0.0;
  for (const NonlinearSample& sample : result.sample) {
    const double depth_m = sample.penetration_m - touch_m;
    if (sample.penetration_m >= from_m && depth_m > 0.0) {
      largest = std::max(largest, kForcePower * sample.give_m / depth_m);
    }
  }
  return largest;
}

// What else of a linear press nonlinear samples tell: energy and contact radius over
// its own, less 1. None where it has none.
std::optional<RelativeCorrection::Knot> shape_knot(const IndentationSample& linear,
                                                   const NonlinearSample& solved,
                                                   double radius_m) {
  if (!(linear.energy_j > 0.0) || !(linear.contact_radius_m > 0.0)) {
    return std::nullopt;
  }
  return RelativeCorrection::Knot{
      linear.penetration_m,
      Eigen::Vector3d(solved.energy_j / linear.energy_j - 1.0,
                      radius_m / linear.contact_radius_m - 1.0, 0.0)};
}

// Solved depths take the solved force; between them the linear force is corrected by
// what the solved ones differ by, relative to it. Where the linear press carries no
// force nothing is relative to it: such paths are solved at every depth.
void correct(PressedNode& node, const NonlinearIndentation& result) {
  node.failure = result.failure;
  node.checks.near_tets = result.near_tets;
  node.checks.newton += result.newton;
  node.checks.gradients += result.gradients;
  auto& path = node.indentation.sample;
  std::vector<RelativeCorrection::Knot> knots;
  std::vector<RelativeCorrection::Knot> shape;
  for (const NonlinearSample& solved : result.sample) {
    const IndentationSample& linear = path[sample_of(solved)];
    node.checks.smallest_jacobian =
        std::min(node.checks.smallest_jacobian, solved.smallest_jacobian);
    const double linear_n = linear.force_n.norm();
    if (linear_n > 0.0) {
      // Knot: (F - F_linear) / |F_linear| [-].
      knots.push_back(
          {linear.penetration_m, (solved.force_n - linear.force_n) / linear_n});
    }
    if (const auto knot = shape_knot(linear, solved, radius_of(solved))) {
      shape.push_back(*knot);
    }
  }
  const std::size_t reached =
      result.sample.empty() ? 0 : sample_of(result.sample.back());
  path.resize(reached + 1);
  // Depths between knots, the far field's nonlinearity, and the contact springs.
  node.indentation.path_error =
      std::hypot(knots.empty() ? 0.0 : interpolation_error(path, knots),
                 result.far_excess_relative,
                 give_error(path.front().penetration_m,
                            kErrorCountsFrom * path.back().penetration_m, result));
  node.indentation.near_singular = result.near_singular;
  if (!knots.empty()) {
    const RelativeCorrection correction(path.front().penetration_m, knots);
    for (IndentationSample& sample : path) {
      const double before_n = sample.force_n.norm();
      sample.force_n += before_n * correction.at(sample.penetration_m);
      sample.coarse_force_n *= before_n > 0.0 ? sample.force_n.norm() / before_n : 1.0;
    }
  }
  if (!shape.empty()) {
    const RelativeCorrection correction(path.front().penetration_m, shape);
    for (IndentationSample& sample : path) {
      const Eigen::Vector3d more = correction.at(sample.penetration_m);
      sample.energy_j *= 1.0 + more[0];
      sample.contact_radius_m *= 1.0 + more[1];
    }
  }
  for (const NonlinearSample& solved : result.sample) {
    const std::size_t k = sample_of(solved);
    path[k].force_n = solved.force_n;
    path[k].energy_j = solved.energy_j;
    path[k].contact_radius_m = radius_of(solved);
    if (node.linear.sample[k].force_n.norm() == 0.0) {
      path[k].coarse_force_n = path[k].force_n.norm();
    }
  }
  cap_force(node, node.path.force_max_n);
}

// Follows the path of the node's linear press by a recipe.
NonlinearIndentation followed(const BodyModel& model,
                              const SurfaceCompliance& compliance,
                              const PressedNode& node, const PressMode& mode,
                              const Recipe& recipe, const RestSolve& solve) {
  const bool has_stiffness = model.stiffness.rows() > 0;
  const NonlinearBody body{model.mesh,
                           model.material,
                           model.supports,
                           model.contact,
                           has_stiffness ? &*model.factor : nullptr,
                           has_stiffness ? &model.stiffness : nullptr};
  // The tangent of the near field can be factored only where the model keeps its
  // stiffness.
  NonlinearOptions options = mode.options;
  options.stiff = options.stiff || recipe.stiff;
  if (recipe.near_gradient > 0.0) {
    options.near_gradient = recipe.near_gradient;
  }
  NonlinearIndentation result = indent_nonlinear(
      body, node.patch, compliance.among(node.patch),
      node.linear.sample.front().penetration_m, steps_of(node, recipe.depths),
      [&](double penetration_m) {
        return tool_at(node.path, penetration_m);
      },
      solve, options);
  spoil(node, result);
  return result;
}

// The lateral stiffness by the tangent where the press ended.
void correct_lateral(const BodyModel& model, const SurfaceCompliance& compliance,
                     PressedNode& node, const NonlinearIndentation& result,
                     const RestSolve& solve) {
  if (!result.converged() || result.sample.empty() ||
      !node.path.tool->shape().presliding_computed) {
    return;
  }
  NearField near(model.mesh, model.material, model.supports, result.near_tet,
                 contact_mesh_nodes(model.contact, node.patch));
  correct_lateral_states({.near = near,
                          .state = result.state,
                          .pressure_n = result.pressure_n,
                          .penetration_m = result.sample.back().penetration_m},
                         solve, model.contact, compliance.among(node.patch), node.patch,
                         node.path, node.indentation);
}

// A node with its linear press, by one recipe.
PressedNode pressed_by(const BodyModel& model, const SurfaceCompliance& compliance,
                       const PressedNode& linear, const PressMode& mode,
                       Attempt attempt, const RestSolve& solve) {
  PressedNode node = linear;
  NonlinearIndentation result;
  contain(node, [&] {
    result = followed(model, compliance, node, mode, attempt.recipe, solve);
    correct(node, result);
    correct_lateral(model, compliance, node, result, solve);
    if (mode.keep_states) {
      node.nonlinear = std::make_shared<const NonlinearIndentation>(result);
    }
  });
  drop_if_broken(node, "nonlinear press");
  attempt.outcome = outcome_of(node);
  attempt.outcome.far_excess_relative = result.far_excess_relative;
  attempt.outcome.near_gradient = result.near_gradient;
  node.tried = {attempt};
  return node;
}

// By all recipes that keep the mesh, one after the other.
void press_one_nonlinear(const BodyModel& model, const SurfaceCompliance& compliance,
                         PressedNode& node, const PressMode& mode,
                         const RestSolve& solve) {
  const RestSolve noted = [&](std::span<const std::int64_t> dof,
                              const Eigen::VectorXd& source, SolveWith with) {
    Eigen::VectorXd u = solve(dof, source, with);
    note_pressed_vertex(node.vertex);  // others had their turn meanwhile
    return u;
  };
  node.linear = node.indentation;
  const PressedNode linear = node;
  Attempt first{.recipe = mode.recipe};
  if (mode.options.depth_error_max == 0.0 || !is_predictor(node.linear)) {
    first.recipe.depths = SolvedDepths::kEvery;
  }
  node = pressed_by(model, compliance, linear, mode, first, noted);
  PressChecks spent = node.checks;
  const PressPolicy policy = policy_of(mode);
  for (auto more = next(node.tried, policy); more && keeps_mesh(more->reason);
       more = next(node.tried, policy)) {
    PressedNode again = pressed_by(model, compliance, linear, mode, *more, noted);
    spent.newton += again.checks.newton;
    spent.gradients += again.checks.gradients;
    take_if_better(node, more->reason, std::move(again));
  }
  node.checks.newton = spent.newton;
  node.checks.gradients = spent.gradients;
}

}  // namespace

NonlinearOptions nonlinear_options(const Scene& scene, const SharedTool& tool) {
  // Tolerances go with the error budget, counted in 5 %. Force of power 1.5 in depth
  // turns a relative deflection of the springs into 1.5 times that of the force.
  const double budgets = scene.force_relative / 0.05;
  const double share = std::min(1.0, budgets);
  NonlinearOptions options{.near_gradient = std::clamp(0.05 * budgets, 0.01, 0.1),
                           .sticking = tool->shape().sticking};
  options.far_excess_max = 0.1 * scene.force_relative;
  options.depth_error_max =
      scene.accuracy.solve_depths == "all" ? 0.0 : 0.3 * scene.force_relative;
  options.give_relative =
      kGiveShare * std::min(0.05, scene.force_relative) / kForcePower;
  options.equilibrium.decrement_relative = std::max(1e-8, 1e-5 * share * share);
  options.equilibrium.multiplier_relative = std::max(0.003, 0.03 * share);
  return options;
}

int nonlinear_depths(const SceneAccuracy& wanted) {
  return static_cast<int>(solved_samples(static_cast<std::size_t>(wanted.depths) + 1,
                                         wanted.solve_depths == "all"
                                             ? SolvedDepths::kEvery
                                             : SolvedDepths::kFew)
                              .size());
}

void probe_nonlinearity(const BodyModel& model, PressedNode& node) {
  constexpr double kShare = 0.5;  // of the displacements: fewer tets turn inside out
  if (node.indentation.sample.size() < 2 || !node.failure.empty()) {
    return;
  }
  contain(node, [&] {
    const Eigen::VectorXd load_n =
        kShare * pressure_load_n(model.contact, node.patch,
                                 node.indentation.sample.back().pressure_n);
    const RestSolve solve = single_solves(*model.factor);
    node.indentation.nonlinearity =
        nonlinearity(model.mesh, model.material,
                     solve(model.supports.free_index, load_n, SolveWith::kFactor));
  });
}

void press_nonlinear(const BodyModel& model, const SurfaceCompliance& compliance,
                     std::span<PressedNode> nodes, const PressMode& mode) {
  std::vector<PressedNode*> pressed;
  for (PressedNode& node : nodes) {
    if (node.indentation.sample.size() > 1) {
      pressed.push_back(&node);
    }
  }
  for (std::size_t first = 0; first < pressed.size(); first += kLockStep) {
    const std::size_t last = std::min(first + kLockStep, pressed.size());
    std::vector<std::function<void(const RestSolve&)>> tasks;
    for (std::size_t i = first; i < last; ++i) {
      tasks.emplace_back([&, node = pressed[i]](const RestSolve& solve) {
        press_one_nonlinear(model, compliance, *node, mode, solve);
        note_pressed_vertex(-1);
      });
    }
    run_in_lock_step(*model.factor, tasks);
  }
}

}  // namespace palpate
