#include "precompute/press/own_mesh_press.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "formats/base/error.h"
#include "precompute/process/supervised_build.h"

namespace palpate {
namespace {

constexpr int kCoarserToMesh = 2;  // meshes, each twice as coarse

// Poisson's ratio below which the factor at rest is the better preconditioner: it asks
// for few gradients there, and leaves presses nearer to balance.
constexpr double kNearlyIncompressible = 0.48;

bool gains_by_tangents(const Scene& scene) {
  return std::any_of(scene.material.begin(), scene.material.end(),
                     [](const SceneMaterial& m) {
                       return m.poissons_ratio > kNearlyIncompressible;
                     });
}

// On a mesh for all of these.
std::vector<PressedNode> press_together(const Scene& scene, const BodySource& body,
                                        const SharedTool& tool,
                                        std::span<const std::int32_t> vertices,
                                        const ContactFocus& focus, PressMode mode) {
  const BodyModel model = make_own_model(
      scene, body, vertices, finer(focus, mode.recipe.times_finer), mode.nonlinear);
  mode.recipe.times_finer *= model.times_finer;
  std::vector<PressedNode> nodes =
      press_on_model(scene, body, model, tool, vertices, mode);
  for (PressedNode& node : nodes) {
    node.tried.front().reason =
        model.times_finer == 1.0 ? Reason::kFirst : Reason::kNoMesh;
  }
  return nodes;
}

}  // namespace

BodyModel make_own_model(const Scene& scene, const BodySource& body,
                         std::span<const std::int32_t> vertices,
                         const ContactFocus& focus, bool nonlinear) {
  const bool keep_stiffness = nonlinear && gains_by_tangents(scene);
  for (int attempt = 0;; ++attempt) {
    const double times_finer = std::ldexp(1.0, -attempt);
    try {
      BodyModel model = make_graded_model(scene, body, vertices,
                                          finer(focus, times_finer), keep_stiffness);
      model.times_finer = times_finer;
      return model;
    } catch (const NumericalError&) {
      if (attempt == kCoarserToMesh) {
        throw;
      }
    }
  }
}

std::vector<PressedNode> press_on_own_mesh(const Scene& scene, const BodySource& body,
                                           const SharedTool& tool,
                                           std::span<const std::int32_t> vertices,
                                           const ContactFocus& focus,
                                           const PressMode& mode) {
  std::vector<PressedNode> nodes =
      press_together(scene, body, tool, vertices, focus, mode);
  const PressPolicy policy = policy_of(mode);
  for (PressedNode& node : nodes) {
    if (signal_of_crash_at(node.vertex) != 0) {
      continue;
    }
    while (const auto more = next(node.tried, policy)) {
      PressedNode again{.vertex = node.vertex, .path = node.path, .tried = {*more}};
      again.tried.front().outcome.failed = true;  // what a press that throws leaves
      PressMode alone = mode;
      alone.recipe = more->recipe;
      contain(again, [&] {
        again =
            press_together(scene, body, tool, {&node.vertex, 1}, focus, alone).front();
      });
      take_if_better(node, more->reason, std::move(again));
    }
  }
  return nodes;
}

}  // namespace palpate
