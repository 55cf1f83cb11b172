// What is stored of a press: a curve of force and displacement, and how far off it may
// be.
#pragma once

#include "formats/response/response_table.h"
#include "precompute/contact/linear_indentation.h"

namespace palpate {

/// What the pressure's mesh makes of the force [-], in force_difference()'s sense,
/// reported by pressure on a mesh twice as coarse. @param indentation with some force.
[[nodiscard]] double pressure_mesh_error(const Indentation& indentation);

/// What the finer one of two meshes makes of the force [-], in the same sense, reported
/// by presses on both. @param finer on a mesh twice as fine; both with some force.
[[nodiscard]] double mesh_error(const NodeResponse& coarse, const NodeResponse& finer,
                                const Eigen::Vector3d& outward);

/// The stored form: |F| against displacement along one direction, the mean of the force
/// along the path. The origin is kSimulated, or kNone where the tool met nothing. The
/// origin is kNone also where no depth carries force.
///
/// The curve is stored as the indentation found it. Its first sample is the first touch
/// of the path, without force. The first touch may be at a negative penetration: a cup
/// touches the tool's side first. A tool may lose contact on its way, or touch twice.
/// Its curve then falls and has depths of zero force between others.
///
/// kErrorOverBudget is set where the tool also reaches elsewhere. Calibration
/// (error_calibration.h) decides whether the error is above the budget.
///
/// `tilt` is the line nearest to the samples' tilts, without limits. For a sticking
/// tool `tilt` is the tilt of the mean direction: friction, too, makes tangential
/// forces.
///
/// error_relative estimates what force_difference() measures, and is to be calibrated.
/// It is the root of the sum of squares of:
/// - the mesh's error: 0.55 of the larger of two differences. One is to the pressure on
///   a mesh twice as coarse. The other is to a whole press on such a mesh, where there
///   is one;
/// - what bears on the patch's edge;
/// - what the line of the tilts misses;
/// - the error of interpolation between depths;
/// - the error of the part left out around;
/// - a fifth of the budget, for what none of these sees.
[[nodiscard]] NodeResponse to_response(const Indentation& indentation,
                                       const IndentationPath& path,
                                       double force_relative_budget);

}  // namespace palpate
