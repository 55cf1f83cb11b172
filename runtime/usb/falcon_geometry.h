// Kinematics of the Novint Falcon, a delta with three legs.
//
// Frame: x right, y up, z towards the user [m]; the tool moves in z = 0.075 to 0.175.
// Leg i stands at azimuth phi = 105, -15, -135 degrees. In its frame
//
//   u = cos(phi) x + sin(phi) y - r,  v = -sin(phi) x + cos(phi) y - s,  w = z
//
// with theta1 the angle of the driven link (length a). theta2 is the angle of the
// parallelogram (length b + d + e) in the leg's plane, theta3 its angle out of the
// plane:
//
//   theta3 = acos((v + f)/b),  L = d + e + b sin(theta3)
//   (u + c - a cos(theta1))^2 + (w - a sin(theta1))^2 = L^2
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace palpate {

/// Middle of the workspace [m], from where a search starts.
[[nodiscard]] inline Eigen::Vector3d falcon_centre_m() {
  return {0.0, 0.0, 0.11};
}

struct FalconPose {
  Eigen::Vector3d theta1 = Eigen::Vector3d::Zero();  ///< [rad] driven links
  /// d theta1 / d position [rad/m], row per leg. The joint torque of a force F on the
  /// tool is rates^-T F.
  Eigen::Matrix3d rates = Eigen::Matrix3d::Zero();
};

/// Joint angles and rates at a position [m]. False, and `pose` untouched, where a leg
/// does not reach, or where its rates are not finite. No allocation.
[[nodiscard]] bool inverse(const Eigen::Vector3d& position_m,
                           FalconPose& pose) noexcept;

struct FalconForward {
  bool converged = false;
  int iterations = 0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< [m]
  FalconPose pose;  ///< at position_m, within one Newton step
};

/// Position for joint angles [rad] by Newton's method on theta1(position), from `start`
/// [m]. Steps are at most 2 cm, halved where a leg does not reach. Converged: the last
/// step was below 1e-10 m. At most 32 iterations; no allocation.
[[nodiscard]] FalconForward forward(const Eigen::Vector3d& theta1_rad,
                                    const Eigen::Vector3d& start_m) noexcept;

/// theta1 [rad] of encoder counts, and back, rounded.
[[nodiscard]] Eigen::Vector3d angles_of(
    const std::array<std::int16_t, 3>& counts) noexcept;
[[nodiscard]] std::array<std::int16_t, 3> counts_of(
    const Eigen::Vector3d& theta1_rad) noexcept;

}  // namespace palpate
