// The same presses for a grid of material parameters.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/measurement/response_sweep.h"
#include "formats/scene/scene.h"
#include "precompute/body/scene_body.h"
#include "precompute/press/node_press.h"
#include "precompute/process/progress.h"

namespace palpate {

/// Count values from `from` to `to`, in equal ratios. @param name "region.constant" or
/// "constant" of the body's material, as material constants are named in the scene.
/// @throws InputError unless 0 < from < to and count is 2 to 100.
[[nodiscard]] SweepParameter grid_of(const std::string& name, double from, double to,
                                     int count);

/// Sets the constant of a scene's material; numbers of a list as "mu_pa.1", from 1.
/// @throws InputError naming the regions or constants that there are.
void set_constant(Scene& scene, const std::string& name, double value);

/// Presses every vertex at every point of the grid, each on a mesh graded to the
/// vertex. A press is as exact as the scene's budget asks for (nonlinear where its laws
/// are). Depths are D (k / n)^2, k = 1 to n, n the scene's number of depths. D is the
/// largest depth that every press reached after its first touch. Forces are those along
/// the tool's way.
///
/// The sweep's error is the largest relative difference from presses on meshes twice as
/// fine. The difference is taken at the middle of the grid, from a tenth of D on. With
/// forces whose error falls as the square of an edge, the difference is three quarters
/// of the error. With the first power, the difference is a half of the error.
/// @throws InputError as set_constant, read_body.
/// @throws NumericalError naming the vertex and the values of a press that failed or
/// met nothing.
[[nodiscard]] ResponseSweep sweep_materials(const Scene& scene, const BodySource& body,
                                            const SharedTool& tool,
                                            std::span<const std::int32_t> vertices,
                                            std::vector<SweepParameter> parameters,
                                            Progress& progress);

}  // namespace palpate
