// What a place would answer if the body were a half space of its own material. The
// estimate is for places that nobody has computed yet, where a user asked for some
// force rather than none. Form, supports, inclusions and large strains are not in it.
// On the demo's organ it is too stiff at every node, up to eight times at 3 mm
// (tests/bench/half_space).
#pragma once

#include <optional>

#include "formats/response/tool_shape.h"
#include "formats/service/service_message.h"

namespace palpate {

/// Force [N] of a rigid tool pressed by depth_m [m] >= 0 into a half space, without
/// friction. For a sphere and a capsule's end it is 4/3 E* sqrt(R) d^1.5 (Hertz 1882).
/// For a flat punch it is 2 E* a d, for a cone 2/pi E* tan(half angle) d^2 (Sneddon
/// 1965). No value for a mesh.
/// @param modulus_pa [Pa] > 0 E* = E / (1 - nu^2).
[[nodiscard]] std::optional<double> half_space_force_n(const ToolShape& tool,
                                                       double modulus_pa,
                                                       double depth_m);

/// For all reachable vertices of the scene, straight out of the surface, up to the
/// scene's depth or force; error_relative 1: not known. Empty where the service did not
/// tell the material's modulus, or for a mesh.
[[nodiscard]] std::vector<WorkUnitNode> estimated_answers(const ServedScene& scene,
                                                          std::int32_t tool);

}  // namespace palpate
