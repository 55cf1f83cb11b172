// Linear presses corrected by the nonlinear body's true response.
#pragma once

#include <span>

#include "precompute/press/node_press.h"

namespace palpate {

/// How many samples of a path are solved nonlinear, unless a few do not tell the rest.
[[nodiscard]] int nonlinear_depths(const SceneAccuracy& wanted);

/// Options as exact as the scene's budget needs. Three errors may take a part of the
/// budget: what the far field's laws add, depths that are not solved, and pressures
/// that springs carry.
[[nodiscard]] NonlinearOptions nonlinear_options(const Scene& scene,
                                                 const SharedTool& tool);

/// Measures how nonlinear the body is where a linear press strains it: one solve, and
/// the energy of the tets around.
void probe_nonlinearity(const BodyModel& model, PressedNode& node);

/// Corrects linear presses by the nonlinear body's response at some of their depths.
/// The correction is the difference of the force vectors, relative to the linear force.
/// It is interpolated between solved depths and zero at first touch. Every depth is
/// solved if the mode says so, or where the linear press is no valid predictor
/// (is_predictor). Every depth is also solved where a few solved depths do not predict
/// those between them (NonlinearOptions::depth_error_max). Nodes go in lock step,
/// blocks of at most 32.
void press_nonlinear(const BodyModel& model, const SurfaceCompliance& compliance,
                     std::span<PressedNode> nodes, const PressMode& mode);

}  // namespace palpate
