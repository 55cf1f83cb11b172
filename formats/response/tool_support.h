// How high a tool's reference point stands over a flat surface that the tool touches.
// The height stands for a sphere's radius where the tool is another.
//
// A response is taken with the reference point at v + (S - delta) n_out, with
//
//   S(n_out) = max over the tool of -n_out . x,   x from the reference point
//
// (FORMAT.md). S is a sphere's radius everywhere. A tool that stands along the normal
// has one S too; a tool of fixed orientation has one for every normal.
#pragma once

#include <Eigen/Core>

#include "formats/response/tool_shape.h"

namespace palpate {

/// S [m] over a surface of that outward normal; infinite where an endless flank lies
/// below its own tip. @param outward [-] unit, world frame. @param tool valid.
[[nodiscard]] double height_at_touch_m(const ToolShape& tool,
                                       const Eigen::Vector3d& outward);

/// [m] >= 0, one for all of a body: S of a tool that stands along the normal. What the
/// fast process counts depths from; the nodes' touch offsets hold the rest.
[[nodiscard]] double nominal_height_m(const ToolShape& tool);

}  // namespace palpate
