#include "precompute/press/own_mesh_press.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "formats/base/error.h"
#include "precompute/process/supervised_build.h"

namespace palpate {
namespace {

constexpr int kFinerForTouch = 3;  // meshes, each twice as fine
constexpr int kCoarserToEnd = 2;   // meshes, each twice as coarse

// Poisson's ratio below which the factor at rest is the better preconditioner: it asks
// for few gradients there, and leaves presses nearer to balance.
constexpr double kNearlyIncompressible = 0.48;

bool gains_by_tangents(const Scene& scene) {
  return std::any_of(scene.material.begin(), scene.material.end(),
                     [](const SceneMaterial& m) {
                       return m.poissons_ratio > kNearlyIncompressible;
                     });
}

// One tool, and meshes made for the vertices that it presses.
class OwnMeshes {
 public:
  OwnMeshes(const Scene& scene, const BodySource& body, const SharedTool& tool)
      : scene_(scene), body_(body), tool_(tool) {}

  [[nodiscard]] std::vector<PressedNode> press(std::span<const std::int32_t> vertices,
                                               const ContactFocus& focus,
                                               const PressMode& mode) const {
    return press_on_model(
        scene_, body_, make_own_model(scene_, body_, vertices, focus, mode.nonlinear),
        tool_, vertices, mode);
  }

  // Gaps are averaged over the hats of contact nodes: smaller hats touch earlier.
  void press_finer_if_late(PressedNode& node, const ContactFocus& focus,
                           const PressMode& mode) const {
    for (int attempt = 1; attempt <= kFinerForTouch; ++attempt) {
      if (!node.failure.empty() || !touches_late(node)) {
        return;
      }
      PressedNode again =
          pressed_again(node, finer(focus, std::ldexp(1.0, attempt)), mode);
      if (samples(again) < 2 ||
          (!again.failure.empty() && samples(again) <= samples(node))) {
        return;  // what is finer would fail, too
      }
      node = std::move(again);
      node.again_times_finer = std::ldexp(1.0, attempt);
    }
  }

  // At a sharp edge large elements are distorted less than small ones, so that more
  // presses converge.
  void press_coarser_if_failed(PressedNode& node, const ContactFocus& focus,
                               PressMode mode) const {
    mode.depths = SolvedDepths::kEvery;
    mode.options.stiff = true;
    for (int attempt = 1; attempt <= kCoarserToEnd && !node.failure.empty();
         ++attempt) {
      PressedNode again =
          pressed_again(node, finer(focus, std::ldexp(1.0, -attempt)), mode);
      // A coarser mesh on which the tool meets nothing is no answer.
      const bool whole = again.failure.empty() && !touches_late(again);
      if (samples(again) > 1 && (whole || samples(again) > samples(node))) {
        node = std::move(again);
        node.again_times_finer = std::ldexp(1.0, -attempt);
      }
    }
  }

 private:
  [[nodiscard]] static std::size_t samples(const PressedNode& node) {
    return node.indentation.sample.size();
  }

  // On another mesh, alone; what goes wrong with it is its failure.
  [[nodiscard]] PressedNode pressed_again(const PressedNode& node,
                                          const ContactFocus& focus,
                                          const PressMode& mode) const {
    PressedNode again{.vertex = node.vertex, .path = node.path};
    contain(again, [&] {
      again = press({&node.vertex, 1}, focus, mode).front();
    });
    return again;
  }

  const Scene& scene_;
  const BodySource& body_;
  const SharedTool& tool_;
};

}  // namespace

BodyModel make_own_model(const Scene& scene, const BodySource& body,
                         std::span<const std::int32_t> vertices,
                         const ContactFocus& focus, bool nonlinear) {
  const bool keep_stiffness = nonlinear && gains_by_tangents(scene);
  for (int attempt = 0;; ++attempt) {
    try {
      return make_graded_model(scene, body, vertices,
                               finer(focus, std::ldexp(1.0, -attempt)), keep_stiffness);
    } catch (const NumericalError&) {
      if (attempt == kCoarserToEnd) {
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
  const OwnMeshes own(scene, body, tool);
  std::vector<PressedNode> nodes = own.press(vertices, focus, mode);
  for (PressedNode& node : nodes) {
    if (signal_of_crash_at(node.vertex) != 0) {
      continue;
    }
    own.press_finer_if_late(node, focus, mode);
    if (mode.nonlinear) {
      own.press_coarser_if_failed(node, focus, mode);
    }
  }
  return nodes;
}

}  // namespace palpate
