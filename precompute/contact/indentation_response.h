// What is stored of a press: a curve of force and displacement, and how far off it may
// be.
#pragma once

#include "formats/response/response_table.h"
#include "precompute/contact/linear_indentation.h"

namespace palpate {

/// What the pressure's mesh makes of the force [-], in force_difference()'s sense, told
/// by pressure on a mesh twice as coarse. @param indentation with some force.
[[nodiscard]] double pressure_mesh_error(const Indentation& indentation);

/// What the finer one of two meshes makes of the force [-], in the same sense, told by
/// presses on both. @param finer on a mesh twice as fine; both with some force.
[[nodiscard]] double mesh_error(const NodeResponse& coarse, const NodeResponse& finer,
                                const Eigen::Vector3d& outward);

/// The stored form: |F| against displacement along one direction, the mean of the force
/// along the path. Origin kSimulated, or kNone where the tool met nothing, which is
/// also so where no depth carries force.
///
/// The curve is stored as it was pressed. Its first sample is the first touch of the
/// path, which may be at a negative penetration (a cup touches the tool's side first),
/// without force; a tool that loses contact on its way, or touches twice, has depths of
/// zero force between others, and a falling curve.
///
/// kErrorOverBudget is set where the tool also reaches elsewhere; whether the error is
/// above the budget is known once it is calibrated (error_calibration.h).
///
/// `tilt` is the line nearest to the samples' tilts, without limits. Of a sticking tool
/// it is the tilt of the mean direction: tangential forces are friction's, too.
///
/// error_relative is an estimate of what force_difference() measures, to be calibrated:
/// what the mesh makes (0.55 of the difference to pressure on a mesh twice as coarse,
/// or, if that is more, to a whole press on one, where there is one), what bears on the
/// patch's edge, what the line of its tilts misses, what interpolation between depths
/// and the part left out around make, and a fifth of the budget for what none of them
/// sees (root of the sum of squares).
[[nodiscard]] NodeResponse to_response(const Indentation& indentation,
                                       const IndentationPath& path,
                                       double force_relative_budget);

}  // namespace palpate
