// Two responses of one node, compared where the tool is at the same place.
//
// A curve is stored over the displacement d along its own direction u, from its own
// first touch. Two curves of a node agree where they give the same force at the same
// normal penetration delta, with d = (delta - touch_offset) |n . u|: a comparison at
// equal d would count a difference of first touches as one of forces.
#pragma once

#include "formats/response/curve_view.h"
#include "formats/response/response_table.h"

namespace palpate {

/// A curve and where it lies along the press.
struct PlacedCurve {
  CurveView curve;              ///< not empty
  double touch_offset_m = 0.0;  ///< [m] normal penetration of its first sample
  double along = 1.0;           ///< [-] |n . u|, (0, 1]

  /// [N] at a normal penetration; zero before the first touch.
  [[nodiscard]] double force_n(double penetration_m) const noexcept {
    return curve.at((penetration_m - touch_offset_m) * along).force_n;
  }

  /// Normal penetration of its last sample [m].
  [[nodiscard]] double end_m() const noexcept {
    return touch_offset_m + curve.depth_max_m() / along;
  }
};

/// A node's curve in a table; the curve may be empty.
[[nodiscard]] PlacedCurve placed_curve(const ResponseTable& table, std::int64_t node,
                                       const Eigen::Vector3d& outward);

/// From this share of the largest depth on errors of forces count, and to this share of
/// the largest force they are relative, where the force is smaller.
inline constexpr double kErrorCountsFrom = 0.1;

/// What `error_relative` bounds: the largest difference of force over all depths from a
/// tenth of the largest penetration on that both reach, relative to the reference's
/// force there or to a tenth of its largest, whichever is more. 0 where neither has a
/// curve, 1 where one alone has.
[[nodiscard]] double force_difference(const PlacedCurve& curve,
                                      const PlacedCurve& reference);

}  // namespace palpate
