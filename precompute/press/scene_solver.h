// Presses of a scene's nodes:
//
//   linear()        linear, on a mesh that many or a few neighbours share
//   refined()       linear, on a finer mesh for each node
//   full()          full-accuracy: the best at the strategy's mesh size
//   with_states()   full-accuracy on the shared mesh, with states as solved
//   reference()     verification: finer mesh, wider nonlinear region, tighter
//   tolerances
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "formats/scene/scene.h"
#include "precompute/body/meshed_body.h"
#include "precompute/body/scene_body.h"
#include "precompute/press/cut_out_press.h"
#include "precompute/press/node_press.h"
#include "precompute/process/progress.h"

namespace palpate {

/// What a scene asks for and its body allows.
struct PressStrategy {
  bool nonlinear = false;  ///< full-accuracy presses solve the nonlinear problem
  /// Linear presses share one uniformly fine mesh and its factor; else every group of
  /// neighbours has a mesh of its own.
  bool shared_mesh = true;
  /// All presses are on submodels cut out of one mesh; no shared_mesh.
  bool cut_out = false;
  bool graded = true;  ///< full presses have a mesh of their own, graded to the contact
  /// Linear presses suffice: the scene asks for no others, or they are as accurate.
  bool linear_is_full = false;
  int subdivisions = 0;    ///< of the surface of the shared mesh, or of that to be cut
  SurfaceMesh surface;     ///< of that mesh
  double spacing_m = 0.0;  ///< [m] contact nodes of that mesh
  ContactFocus focus;      ///< of meshes of full presses
  std::vector<std::string> notes;
};

/// @param pressed vertices that a build presses. A mesh that they share is as fine as
/// the contact wants only around them. `refine = "auto"` chooses the shared mesh by
/// expected_cpu_s(): its factor and columns must cost less than a mesh for each group
/// of neighbours.
[[nodiscard]] PressStrategy choose_strategy(const Scene& scene, const BodySource& body,
                                            std::span<const std::int32_t> pressed);

/// @throws InputError if the scene wants cut-outs, which `task` does not know.
void require_whole_body(const Scene& scene, const std::string& task);

/// [-] Refinement of the mesh of a linear press that is outside the budget.
inline constexpr double kFinerStep = 2.0;

/// The body on the surface that all presses share.
[[nodiscard]] BodyModel make_shared_model(const Scene& scene, const BodySource& body,
                                          const PressStrategy& strategy);

class SceneSolver {
 public:
  /// @param vertices all reachable vertices: they decide the size of the compliance.
  /// @param pressed those that this process will press (one shard's): only their
  /// columns are solved.
  /// @throws InputError, NumericalError where the body cannot be held or meshed: the
  /// shared mesh, or those of its own for each of a few vertices.
  SceneSolver(const Scene& scene, const BodySource& body, const PressStrategy& strategy,
              std::span<const std::int32_t> vertices,
              std::span<const std::int32_t> pressed, Progress& progress);

  /// Linear presses. Safe from several threads, same bits from any.
  [[nodiscard]] std::vector<PressedNode> linear(
      const SharedTool& tool, std::span<const std::int32_t> vertices) const;

  /// The best presses there are at the strategy's mesh size.
  [[nodiscard]] std::vector<PressedNode> full(
      const SharedTool& tool, std::span<const std::int32_t> vertices) const;

  /// The best presses there are on the mesh that all share, with their states
  /// (PressMode::keep_states).
  [[nodiscard]] std::vector<PressedNode> with_states(
      const SharedTool& tool, std::span<const std::int32_t> vertices) const;

  /// Linear presses of nodes for which the strategy's mesh is too coarse. Each has a
  /// mesh of its own: of the strategy's size where the mesh was shared, else kFinerStep
  /// times finer.
  [[nodiscard]] std::vector<PressedNode> refined(
      const SharedTool& tool, std::span<const std::int32_t> vertices) const;

  /// Verification press: on a mesh `times_finer` as fine, nonlinear at
  /// SolvedDepths::kBetween, with a larger nonlinear region and tighter tolerances.
  /// Submodels are wider instead. @param place between vertices, as split_at()'s; at
  /// the vertex where its triangle is -1, and always for submodels.
  [[nodiscard]] PressedNode reference(const SharedTool& tool, std::int32_t vertex,
                                      const SurfacePoint& place,
                                      double times_finer) const;

  /// Called with full-accuracy presses on meshes of their own as they come, from
  /// several threads. A later, better press may replace them. Set before any press.
  using Watch = std::function<void(const SharedTool&, std::span<const PressedNode>)>;
  void watch(Watch watch) { watch_ = std::move(watch); }

  /// None where no mesh is shared.
  [[nodiscard]] const BodyModel* shared() const { return model_ ? &*model_ : nullptr; }

  /// None where nothing is cut out.
  [[nodiscard]] const CutOutSolver* cut_out() const { return cut_out_.get(); }

 private:
  [[nodiscard]] PressMode full_mode(const SharedTool& tool) const;
  [[nodiscard]] std::vector<PressedNode> on_own_meshes(
      const BodySource& body, const SharedTool& tool,
      std::span<const std::int32_t> vertices, const PressMode& mode) const;
  [[nodiscard]] std::vector<PressedNode> on_shared_mesh(
      const SharedTool& tool, std::span<const std::int32_t> vertices,
      const PressMode& mode) const;
  [[nodiscard]] std::vector<PressedNode> on_cut_outs(
      const SharedTool& tool, std::span<const std::int32_t> vertices,
      double times_wider) const;

  const Scene& scene_;
  const BodySource& body_;
  const PressStrategy& strategy_;
  Watch watch_;
  std::unique_ptr<const CutOutSolver> cut_out_;
  std::optional<BodyModel> model_;
  std::optional<SurfaceCompliance> compliance_;
};

}  // namespace palpate
