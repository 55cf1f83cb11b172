// How the force of a node leans off its outward normal, by depth.
//
// The tilt theta is the tangential force over the normal one, N theta = F - N n with
// N = F . n, a tangent vector. Of a press without friction N and N theta are slopes of
// one energy, with depth and along the surface. Over the normal depth past the touch,
// d' = penetration - touch_offset, a node's tilt is kept as a straight line.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "formats/mesh/surface_mesh.h"
#include "formats/response/curve_view.h"

namespace palpate {

struct NodeResponse;
struct ResponseTable;

/// theta(d') = tilt + by_depth_per_m d', both tangent to the node's outward normal.
struct TiltLine {
  Eigen::Vector3d tilt = Eigen::Vector3d::Zero();            ///< [-] at the touch
  Eigen::Vector3d by_depth_per_m = Eigen::Vector3d::Zero();  ///< [1/m]

  /// [-] @param past_touch_m [m] d'.
  [[nodiscard]] Eigen::Vector3d at(double past_touch_m) const {
    return tilt + past_touch_m * by_depth_per_m;
  }
  friend bool operator==(const TiltLine&, const TiltLine&) = default;
};

/// Largest tilt over the depths of a curve [-]: 45 degrees.
inline constexpr double kTiltMost = 1.0;
/// Largest change of tilt over a depth as long as the node's longest edge [-].
inline constexpr double kTiltChangeMost = 0.5;

/// The constant tilt of a force along one direction: u_t / |u . n|.
/// @param direction u, any length but 0. @param outward n, unit.
[[nodiscard]] TiltLine tilt_line(const Eigen::Vector3d& direction,
                                 const Eigen::Vector3d& outward);

/// The line nearest to a press's tilts: least squares weighted with N d(d'), by the
/// trapezoidal rule. Its value at the weights' middle is the tilt of the mean force.
/// Samples whose force does not push outward, N <= 0, do not count.
/// @param past_touch_m (k) [m] d', increasing. @param force_n (k x 3) [N], any scale.
[[nodiscard]] TiltLine tilt_line(std::span<const double> past_touch_m,
                                 const Points& force_n, const Eigen::Vector3d& outward);

/// The tilt of a node within its limits. It is the stored line; else, where directions
/// are stored by sample, the one nearest to those; else that of `direction`. Zero
/// without a response.
/// @param outward normal of the node, unit.
/// @param longest_edge_m [m] at the node; 0: its limit does not count.
[[nodiscard]] TiltLine tilt_line(const ResponseTable& table, std::int64_t node,
                                 const Eigen::Vector3d& outward,
                                 double longest_edge_m = 0.0);

/// Whether a line keeps the limits, to a millionth: |theta| <= kTiltMost over [0,
/// end_m], |by_depth_per_m| longest_edge_m <= kTiltChangeMost.
[[nodiscard]] bool is_within_limits(const TiltLine& line, double end_m,
                                    double longest_edge_m);

/// The line itself where it keeps the limits. Else it turns about its value at
/// middle_m, which is shortened to kTiltMost first, until it does.
/// @param middle_m [m] in [0, end_m].
[[nodiscard]] TiltLine limited(const TiltLine& line, double middle_m, double end_m,
                               double longest_edge_m);

/// Past the touch [m]: where half of the moment of a node's force lies, the mean of d'
/// weighted with force, and the last depth. Zero without a response.
struct TiltRange {
  double middle_m = 0.0;
  double end_m = 0.0;
};
/// @param curve its depths and forces alone are read.
/// @param along |u . n|, [0, 1].
[[nodiscard]] TiltRange tilt_range(const CurveView& curve, double along);
[[nodiscard]] TiltRange tilt_range(const ResponseTable& table, std::int64_t node,
                                   const Eigen::Vector3d& outward);

/// Longest edge at each vertex [m], 0 without one. (n)
[[nodiscard]] std::vector<double> longest_edges_m(const SurfaceMesh& mesh);

/// The unit force that a tilt stands for: n + theta over its length.
[[nodiscard]] Eigen::Vector3d tilted(const Eigen::Vector3d& outward,
                                     const Eigen::Vector3d& tilt);

/// Limits a response's line, if it has one; whether that changed it. The force that is
/// lost counts in error_relative, by the root of the sum of squares.
bool limit_tilt(NodeResponse& response, const Eigen::Vector3d& outward,
                double longest_edge_m);

}  // namespace palpate
