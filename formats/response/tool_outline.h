// The outline of a tool that turns about its axis, for drawing.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "formats/response/tool_shape.h"

namespace palpate {

/// A smooth piece of an outline: points (s, z) [m], s >= 0 the distance from the axis.
using OutlinePiece = std::vector<Eigen::Vector2d>;

/// From the tip on the axis to the axis again, outside to the right. Pieces meet at
/// their ends; arcs are polygons with a corner at every kArcStepRad. Empty for a mesh.
/// @param tool valid. @param end_m [m] > 0 height at which an endless punch is cut off.
/// An endless cone is cut off there too, or where it is as wide as end_m if that is
/// lower.
[[nodiscard]] std::vector<OutlinePiece> tool_outline_m(const ToolShape& tool,
                                                       double end_m);

inline constexpr double kArcStepRad = 0.06;  ///< at most

}  // namespace palpate
