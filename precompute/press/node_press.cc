#include "precompute/press/node_press.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/force_difference.h"
#include "precompute/contact/contact_gap.h"
#include "precompute/contact/held_obstacle.h"
#include "precompute/contact/lateral_state.h"
#include "precompute/contact/other_contact.h"
#include "precompute/contact/patch_state.h"
#include "precompute/press/nonlinear_press.h"
#include "precompute/press/response_ratio.h"
#include "precompute/process/failure_of.h"
#include "precompute/process/fault_point.h"
#include "precompute/process/supervised_build.h"

namespace palpate {
namespace {

// Two contact nodes of one patch are at most twice its radius apart.
double apart_m(const BodyModel& model, std::span<const PressedNode> nodes) {
  double radius_m = 0.0;
  for (const PressedNode& node : nodes) {
    if (!node.patch.empty()) {
      radius_m = std::max(radius_m, patch_radius_m(node.path, model.contact_spacing_m));
    }
  }
  return 2.0 * radius_m;
}

}  // namespace

std::vector<std::int32_t> patches_of(std::span<const PressedNode> nodes) {
  std::vector<std::int32_t> all;
  for (const PressedNode& node : nodes) {
    all.insert(all.end(), node.patch.begin(), node.patch.end());
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

bool touches_late(const PressedNode& node) {
  constexpr double kLate = 0.5 * kErrorCountsFrom;
  const auto& sample = node.indentation.sample;
  return !node.patch.empty() &&
         (sample.size() < 2 ||
          sample.front().penetration_m > kLate * node.path.depth_max_m);
}

Outcome outcome_of(const PressedNode& node) {
  return {.samples = node.indentation.sample.size(),
          .failed = !node.failure.empty(),
          .late = touches_late(node),
          .near_singular = node.indentation.near_singular,
          .between_error = node.indentation.path_error};
}

PressPolicy policy_of(const PressMode& mode) {
  return {.first = mode.recipe,
          .nonlinear = mode.nonlinear,
          .far_excess_max = mode.options.far_excess_max,
          .depth_error_max = mode.options.depth_error_max};
}

bool take_if_better(PressedNode& node, Reason reason, PressedNode again) {
  const bool better = is_better(node.tried[last_taken(node.tried)].outcome, reason,
                                again.tried[last_taken(again.tried)].outcome);
  again.tried.front().reason = reason;
  for (Attempt& attempt : again.tried) {
    attempt.taken = attempt.taken && better;
  }
  std::vector<Attempt> tried = std::move(node.tried);
  tried.insert(tried.end(), again.tried.begin(), again.tried.end());
  if (better) {
    node = std::move(again);
  }
  node.tried = std::move(tried);
  return better;
}

bool ends_at_support(const Scene& scene, const PressedNode& node) {
  return node.failure.empty() && node.indentation.sample.size() > 1 &&
         !node.indentation.force_capped &&
         node.path.depth_max_m < scene.reach.depth_max_m;
}

bool is_nonlinear(const Scene& scene, const BodySource& body) {
  return scene.accuracy.method != "linear" &&
         !std::all_of(body.material.begin(), body.material.end(), is_linear);
}

void contain(PressedNode& node, const std::function<void()>& work) {
  const std::string failure = failure_of("its press", work);
  if (!failure.empty()) {
    node.failure = failure;
    node.patch.clear();
    node.indentation = {};
    node.nonlinear.reset();
  }
}

void drop_if_broken(PressedNode& node, const char* stage) {
  const std::string broken = broken_rule(node.indentation);
  if (!broken.empty()) {
    node.failure = fmt::format("{}: {}", stage, broken);
    node.indentation = {};
  }
}

PressedNode placed_node(const Scene& scene, const BodySource& body,
                        const BodyModel& model, const SharedTool& tool,
                        std::int32_t vertex) {
  PressedNode node{.vertex = vertex,
                   .path = {.vertex_m = body.surface.position_m.row(vertex).transpose(),
                            .outward = body.normal.row(vertex).transpose(),
                            .tool = tool,
                            .depth_max_m = scene.reach.depth_max_m,
                            .force_max_n = scene.reach.force_max_n,
                            .samples = scene.accuracy.depths}};
  if (!(std::abs(node.path.outward.norm() - 1.0) < 1e-6)) {
    node.failure = "its faces look into opposite directions: no normal to press along";
    return node;
  }
  contain(node, [&] {
    node.path.depth_max_m = depth_until_held_m(body.held, node.path);
    const double radius_m = patch_radius_m(node.path, model.contact_spacing_m);
    if (std::isfinite(radius_m)) {
      const std::int32_t start =
          model.contact
              .of_mesh_node[static_cast<std::size_t>(corner_of(model, vertex))];
      node.patch = contact_patch(model.contact, model.supports, start,
                                 node.path.outward, radius_m);
    } else {
      node.failure = "the tool's handle would be in the body";
    }
  });
  // Its patch stays: what others share with it is as it would be without the crash.
  if (const int signal = signal_of_crash_at(vertex); signal != 0) {
    node.failure = fmt::format("its press crashed (signal {})", signal);
  }
  return node;
}

SurfaceCompliance compliance_among(const BodyModel& model,
                                   std::span<const PressedNode> nodes) {
  return {*model.factor, model.supports, model.contact, patches_of(nodes)};
}

SurfaceCompliance compliance_of(
    const BodyModel& model, std::span<const PressedNode> nodes,
    std::span<const char> needed,
    const std::function<void(std::size_t, std::size_t)>& progress) {
  const std::vector<std::int32_t> all = patches_of(nodes);
  return {*model.factor,
          model.supports,
          model.contact,
          all,
          apart_m(model, nodes),
          needed,
          [&](std::size_t done) {
            if (progress) {
              progress(done, all.size());
            }
          }};
}

void press_linear(const BodyModel& model, const SurfaceCompliance& compliance,
                  PressedNode& node, double force_times) {
  if (!node.failure.empty()) {
    return;  // it could not be placed
  }
  note_pressed_vertex(node.vertex);
  contain(node, [&] {
    fault_point(FaultPlace::kWorker, node.vertex);
    IndentationPath path = node.path;
    path.force_max_n *= force_times;
    node.indentation = indent(model.contact, compliance, node.patch, path);
    add_pressure_states(model.contact, node.patch, path, node.indentation);
    if (path.tool->shape().presliding_computed) {
      add_lateral_states(*model.factor, model.supports, model.contact, compliance,
                         node.patch, path, node.indentation);
    }
    for (IndentationSample& sample : node.indentation.sample) {
      fault_point(FaultPlace::kPress, node.vertex,
                  {sample.force_n.data(), std::size_t{3}});
    }
    if (node.indentation.sample.size() > 1) {
      node.indentation.reaches_elsewhere =
          reaches_elsewhere(model.contact, node.patch, node.path,
                            node.indentation.sample.front().penetration_m);
    }
    if (!node.indentation.converged) {
      node.failure = "the contact's complementarity problem did not converge";
      node.indentation.sample.clear();
    }
  });
  drop_if_broken(node, "linear press");
  note_pressed_vertex(-1);
}

void press_placed(const BodyModel& model, const SurfaceCompliance& compliance,
                  std::span<PressedNode> nodes, const PressMode& mode) {
  const bool goes_on = mode.nonlinear || mode.probe;
  for (PressedNode& node : nodes) {
    press_linear(model, compliance, node, goes_on ? kLinearForceTimes : 1.0);
    if (goes_on) {
      probe_nonlinearity(model, node);
    }
  }
  if (mode.nonlinear && !nodes.empty()) {
    PressMode of_tool = mode;
    of_tool.options.sticking = nodes.front().path.tool->shape().sticking;
    press_nonlinear(model, compliance, nodes, of_tool);
  }
  for (PressedNode& node : nodes) {
    if (node.tried.empty()) {  // linear, or failed so
      node.tried.push_back({.recipe = mode.recipe, .outcome = outcome_of(node)});
    }
  }
}

std::vector<PressedNode> press_on_model(const Scene& scene, const BodySource& body,
                                        const BodyModel& model, const SharedTool& tool,
                                        std::span<const std::int32_t> vertices,
                                        const PressMode& mode) {
  std::vector<PressedNode> nodes;
  for (const std::int32_t vertex : vertices) {
    nodes.push_back(placed_node(scene, body, model, tool, vertex));
  }
  press_placed(model, compliance_among(model, nodes), nodes, mode);
  return nodes;
}

}  // namespace palpate
