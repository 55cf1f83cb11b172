#include "precompute/press/scene_solver.h"

#include <algorithm>
#include <functional>
#include <iterator>

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include "formats/base/error.h"
#include "precompute/press/compliance_sample.h"
#include "precompute/press/nonlinear_press.h"
#include "precompute/press/own_mesh_press.h"
#include "precompute/press/press_cost.h"
#include "precompute/process/interrupt.h"
#include "precompute/process/parallel.h"

namespace palpate {
namespace {

using Group = std::vector<std::int32_t>;

// Presses a group; where that throws, its vertices one by one, so that one that cannot
// be meshed or pressed does not cost the others theirs.
std::vector<PressedNode> contained(
    const Group& group,
    const std::function<std::vector<PressedNode>(const Group&)>& press) {
  std::vector<PressedNode> nodes;
  PressedNode whole;
  contain(whole, [&] {
    nodes = press(group);
  });
  if (whole.failure.empty()) {
    return nodes;
  }
  nodes.clear();
  if (group.size() == 1) {
    whole.vertex = group.front();
    whole.tried.push_back({.outcome = outcome_of(whole)});
    nodes.push_back(std::move(whole));
    return nodes;
  }
  for (const std::int32_t vertex : group) {
    check_interrupted();
    nodes.push_back(contained({vertex}, press).front());
  }
  return nodes;
}

// Presses groups side by side; by vertex, ascending.
std::vector<PressedNode> in_groups(
    const std::vector<Group>& groups,
    const std::function<std::vector<PressedNode>(const Group&)>& press) {
  std::vector<std::vector<PressedNode>> pressed(groups.size());
  tbb::this_task_arena::isolate([&] {
    in_parallel(groups.size(), [&](std::size_t i) {
      check_interrupted();
      pressed[i] = contained(groups[i], press);
    });
  });
  std::vector<PressedNode> nodes;
  for (auto& group : pressed) {
    std::move(group.begin(), group.end(), std::back_inserter(nodes));
  }
  std::sort(nodes.begin(), nodes.end(), [](const PressedNode& a, const PressedNode& b) {
    return a.vertex < b.vertex;
  });
  return nodes;
}

constexpr std::size_t kTriedFirst = 3;
// Of tolerances, in presses that others are measured by.
constexpr double kBetterShare = 0.3;
// On finer meshes sharp edges fold more than small steps can follow: to fail costs more
// than many presses, and a coarser mesh answers then.
constexpr int kBetterBisections = 2;

// One surface for all presses: uniformly fine, or only around what is pressed where
// that makes it smaller.
UniformSurface shared_surface(const Scene& scene, const BodySource& body,
                              std::span<const std::int32_t> pressed, double spacing_m,
                              bool everywhere, Eigen::Index most_triangles) {
  constexpr double kMuchSmaller = 0.7;
  UniformSurface uniform = uniform_surface(body, spacing_m, most_triangles);
  if (everywhere || (uniform.subdivisions == 0 && uniform.fine_enough)) {
    return uniform;
  }
  UniformSurface around =
      pressed_surface(body, pressed, spacing_m,
                      touched_radius_m(scene, body, spacing_m), most_triangles);
  const bool smaller =
      static_cast<double>(around.surface.triangle.rows()) <
      kMuchSmaller * static_cast<double>(uniform.surface.triangle.rows());
  return around.fine_enough && (smaller || !uniform.fine_enough) ? around : uniform;
}

bool sharing_costs_less(const Scene& scene, const BodySource& body,
                        std::span<const std::int32_t> pressed,
                        const UniformSurface& shared, const ContactFocus& focus) {
  const double triangles = static_cast<double>(shared.surface.triangle.rows());
  const std::int64_t columns =
      contact_nodes_near(shared.surface, body, pressed,
                         touched_radius_m(scene, body, shared.node_spacing_m));
  const double shared_s = expected_cpu_s({triangles, static_cast<double>(columns)});
  constexpr double kNothing = 1.0;  // [s] not worth a second look
  return shared_s < kNothing ||
         shared_s < expected_own_meshes_cpu_s(scene, body, pressed, focus);
}

// Meshes some vertices' bodies; a body that cannot be held or meshed at all is refused
// here, before any unit. Where some can be meshed, others fail alone.
void require_own_meshes(const Scene& scene, const BodySource& body,
                        std::span<const std::int32_t> vertices,
                        const ContactFocus& focus) {
  const auto tried = spread_over(vertices, kTriedFirst);
  for (std::size_t i = 0; i < tried.size(); ++i) {
    try {
      (void)make_own_model(scene, body, {&tried[i], 1}, focus);
      return;
    } catch (const NumericalError&) {
      if (i + 1 == tried.size()) {
        throw;
      }
    }
  }
}

}  // namespace

PressStrategy choose_strategy(const Scene& scene, const BodySource& body,
                              std::span<const std::int32_t> pressed) {
  PressStrategy strategy;
  const bool sticking =
      std::any_of(scene.tool.begin(), scene.tool.end(), [](const ToolShape& tool) {
        return tool.sticking;
      });
  strategy.nonlinear =
      scene.accuracy.method == "nonlinear" || is_nonlinear(scene, body) || sticking;
  strategy.focus = contact_focus(scene, body);
  strategy.cut_out = scene.cutout.has_value();
  if (strategy.cut_out && strategy.nonlinear) {
    throw InputError(fmt::format(
        "[cutout] is for linear responses: {}",
        sticking ? "a tool's contact is \"sticking\", must be \"frictionless\""
                 : "set accuracy.method to \"linear\", or take [cutout] out"));
  }
  const std::string& refine = scene.accuracy.refine;
  // Where there is a choice, a mesh for all must be as fine as those for each.
  const double wanted_m = refine == "auto" && !strategy.cut_out
                              ? 0.5 * strategy.focus.finest_m
                              : uniform_spacing_m(scene, body, strategy.nonlinear);
  const UniformSurface shared = shared_surface(
      scene, body, pressed, wanted_m, strategy.cut_out || refine == "global",
      strategy.cut_out ? kMostCutTriangles : kMostTriangles);
  strategy.subdivisions = shared.subdivisions;
  strategy.spacing_m = shared.node_spacing_m;
  strategy.surface = shared.surface;
  strategy.shared_mesh =
      !strategy.cut_out &&
      (refine == "global" ||
       (refine == "auto" && shared.fine_enough &&
        sharing_costs_less(scene, body, pressed, shared, strategy.focus)));
  strategy.graded = !strategy.cut_out && refine != "global";
  strategy.linear_is_full = !strategy.nonlinear;
  if ((strategy.shared_mesh || strategy.cut_out) && !shared.fine_enough) {
    strategy.notes.push_back(fmt::format(
        "contact nodes are {:.3g} mm apart where the scene asks for {:.3g} mm: a finer "
        "surface would be too large; refine = \"local\" meshes the contact alone",
        1e3 * shared.node_spacing_m, 1e3 * wanted_m));
  }
  return strategy;
}

void require_whole_body(const Scene& scene, const std::string& task) {
  if (scene.cutout) {
    throw InputError(fmt::format(
        "{} presses the whole body: the scene has [cutout], must have none", task));
  }
}

BodyModel make_shared_model(const Scene& scene, const BodySource& body,
                            const PressStrategy& strategy) {
  BodyModel model = make_body_model(scene, body, strategy.surface);
  model.contact_spacing_m = strategy.spacing_m;
  return model;
}

SceneSolver::SceneSolver(const Scene& scene, const BodySource& body,
                         const PressStrategy& strategy,
                         std::span<const std::int32_t> vertices,
                         std::span<const std::int32_t> pressed, Progress& progress)
    : scene_(scene), body_(body), strategy_(strategy) {
  if (strategy.cut_out) {
    progress.stage("mesh to cut from, coarse body");
    cut_out_ = std::make_unique<const CutOutSolver>(scene, body, strategy.surface,
                                                    strategy.spacing_m, vertices);
  }
  if (!strategy.shared_mesh) {
    if (!strategy.cut_out) {
      require_own_meshes(scene, body, pressed, strategy.focus);
    }
    return;
  }
  progress.stage("shared mesh and factor");
  model_.emplace(make_shared_model(scene, body, strategy));
  progress.stage("surface compliance");
  // Every vertex of every tool is placed, so that the pairs that are kept do not depend
  // on `pressed`. Columns are solved only for vertices that are pressed.
  std::vector<PressedNode> placed;
  std::vector<char> wanted(model_->contact.node.size(), 0);
  for (const SharedTool& tool : body.tool) {
    for (const std::int32_t v : vertices) {
      placed.push_back(placed_node(scene, body, *model_, tool, v));
      if (std::binary_search(pressed.begin(), pressed.end(), v)) {
        for (const std::int32_t c : placed.back().patch) {
          wanted[static_cast<std::size_t>(c)] = 1;
        }
      }
    }
  }
  compliance_.emplace(
      compliance_of(*model_, placed, wanted, [&](std::size_t done, std::size_t total) {
        progress.advance(done, total, "columns");
      }));
}

std::vector<PressedNode> SceneSolver::linear(
    const SharedTool& tool, std::span<const std::int32_t> vertices) const {
  const PressMode mode{.probe = strategy_.nonlinear};
  if (strategy_.shared_mesh) {
    return on_shared_mesh(tool, vertices, mode);
  }
  return strategy_.cut_out ? on_cut_outs(tool, vertices, 1.0)
                           : on_own_meshes(body_, tool, vertices, mode);
}

std::vector<PressedNode> SceneSolver::on_cut_outs(
    const SharedTool& tool, std::span<const std::int32_t> vertices,
    double times_wider) const {
  return in_groups(cut_out_->groups(vertices), [&](const Group& group) {
    return cut_out_->press(tool, group, times_wider);
  });
}

std::vector<PressedNode> SceneSolver::on_own_meshes(
    const BodySource& body, const SharedTool& tool,
    std::span<const std::int32_t> vertices, const PressMode& mode) const {
  const ContactFocus& focus = strategy_.focus;
  return in_groups(group_presses(body.surface, vertices,
                                 finer(focus, mode.recipe.times_finer), mode.nonlinear),
                   [&](const Group& group) {
                     auto nodes =
                         press_on_own_mesh(scene_, body, tool, group, focus, mode);
                     const bool final_mode = mode.nonlinear == strategy_.nonlinear &&
                                             mode.recipe.depths == SolvedDepths::kFew;
                     if (watch_ && final_mode) {
                       watch_(tool, nodes);
                     }
                     return nodes;
                   });
}

PressMode SceneSolver::full_mode(const SharedTool& tool) const {
  return {.nonlinear = strategy_.nonlinear, .options = nonlinear_options(scene_, tool)};
}

std::vector<PressedNode> SceneSolver::full(
    const SharedTool& tool, std::span<const std::int32_t> vertices) const {
  if (strategy_.cut_out) {
    return on_cut_outs(tool, vertices, 1.0);
  }
  return strategy_.graded ? on_own_meshes(body_, tool, vertices, full_mode(tool))
                          : on_shared_mesh(tool, vertices, full_mode(tool));
}

std::vector<PressedNode> SceneSolver::with_states(
    const SharedTool& tool, std::span<const std::int32_t> vertices) const {
  PressMode mode = full_mode(tool);
  mode.keep_states = true;
  return on_shared_mesh(tool, vertices, mode);
}

std::vector<PressedNode> SceneSolver::on_shared_mesh(
    const SharedTool& tool, std::span<const std::int32_t> vertices,
    const PressMode& mode) const {
  std::vector<PressedNode> nodes;
  for (const std::int32_t v : vertices) {
    nodes.push_back(placed_node(scene_, body_, *model_, tool, v));
  }
  press_placed(*model_, *compliance_, nodes, mode);
  return nodes;
}

std::vector<PressedNode> SceneSolver::refined(
    const SharedTool& tool, std::span<const std::int32_t> vertices) const {
  return on_own_meshes(
      body_, tool, vertices,
      {.recipe = {.times_finer = strategy_.shared_mesh ? 1.0 : kFinerStep}});
}

PressedNode SceneSolver::reference(const SharedTool& tool, std::int32_t vertex,
                                   const SurfacePoint& place,
                                   double times_finer) const {
  if (strategy_.cut_out) {
    return on_cut_outs(tool, {&vertex, 1}, kCutStep).front();
  }
  // A reference solves other depths, with tighter tolerances, on a finer mesh.
  PressMode mode = full_mode(tool);
  mode.recipe = {.times_finer = times_finer, .depths = SolvedDepths::kBetween};
  NonlinearOptions& options = mode.options;
  options.near_gradient *= kBetterShare;
  options.give_relative *= kBetterShare;
  options.equilibrium.decrement_relative *= kBetterShare;
  options.equilibrium.multiplier_relative *= kBetterShare;
  options.bisections_max = kBetterBisections;
  if (place.triangle < 0) {
    return on_own_meshes(body_, tool, {&vertex, 1}, mode).front();
  }
  const BodySource body = with_vertex_at(body_, place);
  const auto added = static_cast<std::int32_t>(body_.surface.position_m.rows());
  return on_own_meshes(body, tool, {&added, 1}, mode).front();
}

}  // namespace palpate
