// Where a contact presses. What couples contacts is a compliance: the displacement
// under the whole of one contact for a force on the whole of another. The compliance
// from point to point differs much from it at edges and tips.
#pragma once

#include <span>

#include <Eigen/Core>

#include "precompute/body/meshed_body.h"
#include "precompute/contact/loaded_part.h"
#include "precompute/contact/surface_compliance.h"
#include "precompute/press/node_press.h"

namespace palpate {

/// The pressure with which a tool presses a linear body to half of the largest depth,
/// as forces whose resultant is 1 N. A vertex that cannot be pressed, or at which
/// nothing is touched, is loaded alone.
/// @param compliance of the model, with all nodes of the patch.
[[nodiscard]] PressureForces contact_spot(const BodyModel& model,
                                          const SurfaceCompliance& compliance,
                                          const PressedNode& placed);

/// Compliances between spots (n x n) [m/N], symmetric.
/// @param compliance among all nodes of all spots.
[[nodiscard]] Eigen::MatrixXd between_spots(const SurfaceCompliance& compliance,
                                            std::span<const PressureForces> spots);

}  // namespace palpate
