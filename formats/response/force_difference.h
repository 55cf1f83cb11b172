// Two responses of one node, compared as vectors where the tool is at the same place.
//
// A curve is stored over the displacement d along its own direction u, from its own
// first touch. Two curves of a node agree where they give the same force at the same
// normal penetration delta, with d = (delta - touch_offset) |n . u|: a comparison at
// equal d would count a difference of first touches as one of forces.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "formats/response/curve_view.h"
#include "formats/response/response_table.h"
#include "formats/response/tilt_line.h"

namespace palpate {

/// A curve, where it lies along the press, and which way its force points.
struct PlacedCurve {
  CurveView curve;              ///< not empty
  double touch_offset_m = 0.0;  ///< [m] normal penetration of its first sample
  double along = 1.0;           ///< [-] |n . u|, (0, 1]
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< [-] u, unit
  Eigen::Vector3d outward = Eigen::Vector3d::UnitZ();    ///< [-] n, unit
  std::optional<TiltLine> tilt = {};
  std::span<const double> sample_direction = {};  ///< (3 k) [-] or empty

  /// [-] Unit vector at a normal penetration, as a hand gets it: n + theta of the tilt.
  /// Without a tilt the vector is that of the samples, linear between samples and
  /// renormalised; without those, u.
  [[nodiscard]] Eigen::Vector3d direction_at(double penetration_m) const noexcept;

  /// [N] at a normal penetration; zero before the first touch.
  [[nodiscard]] Eigen::Vector3d force_n(double penetration_m) const noexcept {
    return curve.at((penetration_m - touch_offset_m) * along).force_n *
           direction_at(penetration_m);
  }

  /// Normal penetration of its last sample [m].
  [[nodiscard]] double end_m() const noexcept {
    return touch_offset_m + curve.depth_max_m() / along;
  }
};

/// A node's curve in a table; the curve may be empty.
[[nodiscard]] PlacedCurve placed_curve(const ResponseTable& table, std::int64_t node,
                                       const Eigen::Vector3d& outward);

/// Errors of forces count from this share of the largest depth on. Where the force is
/// smaller than this share of the largest force, errors are relative to that share.
inline constexpr double kErrorCountsFrom = 0.1;

/// Normal penetrations [m] at which a force is compared with a reference: evenly from a
/// tenth of the reference's largest to where both end. @param end_m [m] of the force's.
[[nodiscard]] std::vector<double> compared_depths_m(double end_m,
                                                    const PlacedCurve& reference);

/// What `error_relative` bounds: the largest difference |F - F'| of the force vectors.
/// Depths count from a tenth of the largest penetration on that both reach. The
/// difference is relative to the reference's force there or to a tenth of its largest,
/// whichever is more.
/// @param depth_m (k) [m] of compared_depths_m(). @param force_n (k x 3) [N] there.
[[nodiscard]] double force_difference(std::span<const double> depth_m,
                                      const Points& force_n,
                                      const PlacedCurve& reference);

/// The same of two curves. 0 where neither has a curve, 1 where one alone has.
[[nodiscard]] double force_difference(const PlacedCurve& curve,
                                      const PlacedCurve& reference);

}  // namespace palpate
