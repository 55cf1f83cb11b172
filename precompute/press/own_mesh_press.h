// Pressing nodes of a scene on meshes that are made for them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/body/mesh_grading.h"
#include "precompute/press/node_press.h"

namespace palpate {

/// The body meshed around the vertices (make_graded_model), or, where that mesh cannot
/// be made, two or four times coarser there (BodyModel::times_finer). @throws as
/// make_graded_model() where none can. @param nonlinear presses follow: with what those
/// of a nearly incompressible body need besides (TangentFactor).
[[nodiscard]] BodyModel make_own_model(const Scene& scene, const BodySource& body,
                                       std::span<const std::int32_t> vertices,
                                       const ContactFocus& focus,
                                       bool nonlinear = false);

/// Meshes the body around the vertices, as fine as the mode's recipe says, and presses
/// them with the tool. A vertex for which that does not do is pressed by what next()
/// says, on meshes of its own. The estimated error of forces is of the mesh that was
/// taken.
/// @throws as make_own_model(), for the first mesh.
[[nodiscard]] std::vector<PressedNode> press_on_own_mesh(
    const Scene& scene, const BodySource& body, const SharedTool& tool,
    std::span<const std::int32_t> vertices, const ContactFocus& focus,
    const PressMode& mode);

}  // namespace palpate
