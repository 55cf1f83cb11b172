// How far a point of the surface is from a tool, as small-strain contact sees it: along
// the direction of the press.
#pragma once

#include <Eigen/Core>

#include "precompute/contact/contact_surface.h"
#include "precompute/contact/tool_surface.h"

namespace palpate {

/// How far a surface point can move out along its normal before it meets the tool, and
/// the derivative with the tool's position.
struct Gap {
  double distance_m = 0.0;  ///< [m] negative where the tool reaches in
  Eigen::Vector3d by_tool;  ///< [-] d(distance)/d(reference)
};

/// The gap is (press . n) times the height t of the tool's near side above the point,
/// seen along `press`. To first order, the gap is the distance along the normal n. Its
/// derivative with the tool's position is n where the tool touches. D is the distance
/// to the tool, n_D the gradient of D, c = steepest_cosine():
///
///     D(p + t press) = 0, the lower root, where -n_D . press >= c there, else
///     t = min over tau of tau + D(p + tau press) / c.
///
/// The second case goes on with the slope of the steepest part that counts. So the
/// height is convex and C1 everywhere, and walls do not enter. In both cases
/// dt/d(reference) = n_D / (n_D . press). For a sphere t = -b - sqrt(R^2 - s^2),
/// straight beyond s = 0.95 R. There r = p - centre, b = press . r, s = |r - b press|.
/// The gap is zero where the surface faces away.
///
/// No point meets the tool before the point has moved by D. Outside the tool the gap is
/// therefore D where D is larger. D is larger on steep walls far below the tool, whose
/// height counts little along their normals. D is never larger on a surface across the
/// press (D <= t).
[[nodiscard]] Gap tool_gap(const Eigen::Vector3d& p_m, const Eigen::Vector3d& normal,
                           const PlacedTool& tool);

/// Average of tool_gap over a contact node's hat.
[[nodiscard]] Gap average_gap(const ContactNode& node, const PlacedTool& tool);

/// Largest distance [m] from the line through the reference along `press` at which the
/// tool's near side still counts. The near side counts up to height_m above the tool's
/// lowest point; for a sphere the distance is at most R. NaN where the tool is not
/// placed.
[[nodiscard]] double shadow_radius_m(const PlacedTool& tool, double height_m);

}  // namespace palpate
