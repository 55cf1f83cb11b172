// What a body truly answers: presses solved at a finer level, anywhere on the surface.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "formats/scene/scene.h"
#include "precompute/body/scene_body.h"
#include "tests/peers/hand_paths.h"

namespace palpate::peers {

/// A press at one place along its normal.
struct TrueCurve {
  std::vector<double> depth_m;           ///< ascending, from the first touch
  std::vector<Eigen::Vector3d> force_n;  ///< on the tool
  std::string failure;                   ///< why there is none, else empty

  /// Between the samples straight in each component; zero before the first. Samples
  /// are close: 1e-4 of the force is missed.
  [[nodiscard]] Eigen::Vector3d at(double depth_m) const;
};

/// Presses the scene's first tool to each place's depth, on a mesh so many times finer
/// than the scene's budget asks for. One mesh serves all places where the materials are
/// linear; else there is one graded to each place and nonlinear. An equilibrium without
/// friction does not depend on the way there: the force is that on a tool that has come
/// from anywhere.
[[nodiscard]] std::vector<TrueCurve> true_curves(const Scene& scene,
                                                 const BodySource& body,
                                                 std::span<const PlacedDepth> places,
                                                 double times_finer);

}  // namespace palpate::peers
