// Pressing nodes on parts that are cut out of the body around them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/scene/scene.h"
#include "precompute/body/coarse_body.h"
#include "precompute/body/cut_out.h"
#include "precompute/body/scene_body.h"
#include "precompute/press/node_press.h"

namespace palpate {

/// [-] Factor between the parts that are compared. Checks of a node are on a part wider
/// by this factor. The estimate of what the cut costs has a part narrower by this
/// factor, in front of a body coarser by this factor.
inline constexpr double kCutStep = 1.5;

/// Past this many surface triangles the tets alone are too many for the mesher.
inline constexpr Eigen::Index kMostCutTriangles = 1'200'000;

/// What the scene's cut-outs leave out of every response; empty without them.
[[nodiscard]] std::string cut_out_text(const Scene& scene);

class CutOutSolver {
 public:
  /// Meshes the body; factorises nothing but the coarse body.
  /// @param scene with a cutout. @param surface of the body, refined; its first
  /// vertices are the body's. @param spacing_m [m] of contact nodes under the tools.
  /// @param vertices every one that will be pressed.
  /// @throws InputError if the radius is too small for one of the tools at one of the
  /// vertices, or as CoarseBody.
  CutOutSolver(const Scene& scene, const BodySource& body, const SurfaceMesh& surface,
               double spacing_m, std::span<const std::int32_t> vertices);

  /// Vertices that share a part: neighbours, no farther apart than a fraction of the
  /// radius.
  [[nodiscard]] std::vector<std::vector<std::int32_t>> groups(
      std::span<const std::int32_t> vertices) const;

  /// Linear presses of one group, with an estimate of what the cut costs. Safe from
  /// several threads, same bits from any.
  [[nodiscard]] std::vector<PressedNode> press(const SharedTool& tool,
                                               std::span<const std::int32_t> group,
                                               double times_wider = 1.0) const;

  /// The same on a part that was made for the group, without the estimate.
  [[nodiscard]] std::vector<PressedNode> press_on(
      const ClampedPart& part, const SharedTool& tool,
      std::span<const std::int32_t> group) const;

  /// What is cut from what, one line.
  [[nodiscard]] std::string text() const;

  [[nodiscard]] const TetMesh& tets() const { return tets_.mesh; }
  /// None where the cut is clamped.
  [[nodiscard]] const CoarseBody* coarse() const { return coarse_.get(); }
  /// The part around a group. @param radius_m [m] the scene's, if it is to be pressed.
  [[nodiscard]] ClampedPart part(std::span<const std::int32_t> group,
                                 double radius_m) const;

 private:
  [[nodiscard]] static SurfaceCompliance compliance(const ClampedPart& part,
                                                    std::span<const PressedNode> nodes,
                                                    const CoarseBody* exterior);
  void estimate(std::span<PressedNode> nodes, std::span<const std::int32_t> group,
                double radius_m) const;

  const Scene& scene_;
  const BodySource& body_;
  ConnectedTets tets_;
  double contact_spacing_m_ = 0.0;
  std::unique_ptr<const CoarseBody> coarse_;
  std::unique_ptr<const CoarseBody> coarser_;  // for estimates
};

}  // namespace palpate
