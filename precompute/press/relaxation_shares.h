// How each node's response relaxes where the body's materials relax differently.
//
// By the correspondence principle (material_spectrum.h) linear presses of the body with
// transformed moduli give the transform of F(t) / F(0) at a few rates s, and
//
//   1 - sum g_k / (1 + s tau_k),   g_k >= 0,   sum g_k <= 1,
//
// is fitted to it by least squares. Exact for a contact whose area stays while it is
// held, and as far as the tool's few times can say it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "formats/response/viscoelasticity.h"
#include "formats/scene/scene.h"
#include "precompute/body/scene_body.h"
#include "precompute/press/scene_solver.h"
#include "precompute/process/progress.h"

namespace palpate {

/// One node's.
struct FittedShares {
  Eigen::RowVectorXd g;  ///< (K) [-] >= 0, sum at most 1
  double rms = 0.0;      ///< [-] of what the fit misses
};

/// @param tau_s      (K) [s] at most kMostTerms, increasing.
/// @param rate_per_s (m) [1/s], m >= K.
/// @param share      (m) [-] transform of F(t) / F(0).
[[nodiscard]] FittedShares fit_shares(const std::vector<double>& tau_s,
                                      const std::vector<double>& rate_per_s,
                                      const Eigen::VectorXd& share);

/// Shares of some nodes for every tool, by linear presses. A node of which no press
/// tells has those of the nearest that has some, and the largest error.
/// error_relative: what the fit misses, and how the share varies with depth.
/// @param vertices of the body that have responses, by tool, ascending.
/// @param tau_s common times (spectrum_of).
/// @returns by tool a table with rows for all vertices of the body, at others the mean.
/// @throws as SceneSolver; NumericalError where no press of a tool tells anything.
[[nodiscard]] std::vector<Viscoelasticity> relaxation_shares(
    const Scene& scene, const BodySource& body, const PressStrategy& strategy,
    std::span<const std::vector<std::int32_t>> vertices,
    const std::vector<double>& tau_s, Progress& progress);

}  // namespace palpate
