// Pressing nodes of a scene on one model of its body: linear, then corrected by the
// true nonlinear response where that is asked for.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/scene/scene.h"
#include "precompute/body/meshed_body.h"
#include "precompute/body/scene_body.h"
#include "precompute/contact/linear_indentation.h"
#include "precompute/contact/nonlinear_indentation.h"
#include "precompute/contact/surface_compliance.h"
#include "precompute/press/recipe.h"

namespace palpate {

using SharedTool = std::shared_ptr<const ToolSurface>;

/// What a press cost and how far it can be trusted.
struct PressChecks {
  std::int64_t newton = 0;         ///< steps, all depths
  std::int64_t gradients = 0;      ///< conjugate gradients, one solve each
  std::int64_t near_tets = 0;      ///< treated as nonlinear
  double smallest_jacobian = 1.0;  ///< [-] det F anywhere, any depth
};

struct PressMode {
  bool nonlinear = false;
  Recipe recipe = {};             ///< the first
  NonlinearOptions options = {};  ///< but for sticking, which is the tool's
  bool keep_states = false;       ///< of nonlinear presses, in PressedNode::nonlinear
  /// Linear presses are what others are made of: they measure
  /// Indentation::nonlinearity, and go on to kLinearForceTimes.
  bool probe = false;
};

struct PressedNode {
  std::int32_t vertex = -1;
  IndentationPath path;
  std::vector<std::int32_t> patch =
      {};  ///< contact nodes of the model; empty: no press
  Indentation indentation = {};
  std::string failure = {};  ///< why the path ends early, or is missing; else empty
  PressChecks checks = {};
  /// What a nonlinear press corrected: the linear one on the same mesh.
  Indentation linear = {};
  /// As solved, where PressMode::keep_states; else null.
  std::shared_ptr<const NonlinearIndentation> nonlinear = {};
  std::vector<Attempt> tried = {};  ///< what was, in order; empty: not pressed yet
};

/// What the node's press came to, as far as that needs no estimate of its error.
[[nodiscard]] Outcome outcome_of(const PressedNode& node);

/// What attempts in this mode are judged by.
[[nodiscard]] PressPolicy policy_of(const PressMode& mode);

/// Takes what was pressed again for this reason where it is better; both keep what was
/// tried. @returns whether it was taken.
bool take_if_better(PressedNode& node, Reason reason, PressedNode again);

/// Whether the mesh is too coarse for the vertex. Where the tool's end has reached the
/// vertex, at zero penetration, the tool touches the body. But gaps are averaged over
/// the hats of contact nodes, and around a corner or on a spike the average lies
/// behind. True where the first touch comes after a twentieth of the largest depth, or
/// not at all. Errors of force begin to count at twice that depth.
[[nodiscard]] bool touches_late(const PressedNode& node);

/// Whether a press that went to its end ended short of the depth that the scene wants
/// because of a support. There the tool meets a part of the body that is held
/// (depth_until_held_m).
[[nodiscard]] bool ends_at_support(const Scene& scene, const PressedNode& node);

/// Whether the scene's materials and method ask for nonlinear solutions.
[[nodiscard]] bool is_nonlinear(const Scene& scene, const BodySource& body);

/// Does a part of a node's work. Whatever it throws, but Interrupted, becomes the
/// node's failure, and what it has computed is dropped: a node's fault is its own.
void contain(PressedNode& node, const std::function<void()>& work);

/// Drops what a node has computed where a number of it breaks a rule (broken_rule), and
/// says so as its failure. @param stage "linear press", for the message.
void drop_if_broken(PressedNode& node, const char* stage);

/// The path and the patch of a vertex, not pressed yet. A vertex that cannot be pressed
/// has a failure and no patch.
[[nodiscard]] PressedNode placed_node(const Scene& scene, const BodySource& body,
                                      const BodyModel& model, const SharedTool& tool,
                                      std::int32_t vertex);

/// Contact nodes of the nodes' patches, ascending.
[[nodiscard]] std::vector<std::int32_t> patches_of(std::span<const PressedNode> nodes);

/// Compliance among the patches of the nodes, which are few: all that their model was
/// made for.
[[nodiscard]] SurfaceCompliance compliance_among(const BodyModel& model,
                                                 std::span<const PressedNode> nodes);

/// Compliance among the patches of the nodes, column by column.
/// @param wanted by contact node: 1 where its column is needed (empty: all).
/// @param progress called with columns done and in all; may be null.
[[nodiscard]] SurfaceCompliance compliance_of(
    const BodyModel& model, std::span<const PressedNode> nodes,
    std::span<const char> wanted,
    const std::function<void(std::size_t done, std::size_t total)>& progress);

/// Force at which a linear press ends that other presses are made of, over the scene's
/// largest force [-]. The linear body may be stiffer than the true one, and its force
/// says little about where the path ends.
inline constexpr double kLinearForceTimes = 3.0;

/// Presses a placed node into the linear body.
/// @param force_times [-] of the path's largest force, where it ends.
void press_linear(const BodyModel& model, const SurfaceCompliance& compliance,
                  PressedNode& node, double force_times = 1.0);

/// Presses placed nodes: linear, and by what the mode says. A node that fails has its
/// reason; the others are what they would be without it.
void press_placed(const BodyModel& model, const SurfaceCompliance& compliance,
                  std::span<PressedNode> nodes, const PressMode& mode);

/// Presses the vertices on a model that was made for them, as press_placed().
[[nodiscard]] std::vector<PressedNode> press_on_model(
    const Scene& scene, const BodySource& body, const BodyModel& model,
    const SharedTool& tool, std::span<const std::int32_t> vertices,
    const PressMode& mode);

}  // namespace palpate
