// Kinematics of a planar five-bar with two driven links: the Haply 2diy.
//
// Frame [m]: the motors sit at b_1 = (d/2, 0) and b_2 = (-d/2, 0). Driven links of
// length l end at e_i = b_i + l (cos theta_i, sin theta_i). Two links of length L meet
// at the tool p. So |p - e_i| = L, and its derivative is
//
//   (p - e_i) . dp = l (p - e_i) . t_i dtheta_i,   t_i = (-sin theta_i, cos theta_i).
#pragma once

#include <Eigen/Core>

namespace palpate {

struct PantographLinks {
  double driven_m = 0.050;  ///< [m] (0, inf) l
  double free_m = 0.070;    ///< [m] (0, inf) L
  double base_m = 0.020;    ///< [m] [0, inf) d
  int side = 1;             ///< +1: the tool is beyond the line of the elbows (+y); -1
  int elbow = 1;            ///< +1: elbows outwards, -1: inwards; for inverse() alone
};

/// @throws InputError naming the value that is out of range.
void check(const PantographLinks& links);

struct PantographPose {
  Eigen::Vector2d theta = Eigen::Vector2d::Zero();       ///< [rad]
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< [m]
  /// d position / d theta [m/rad]. The joint torque of a force F is jacobian^T F.
  Eigen::Matrix2d jacobian = Eigen::Matrix2d::Zero();
  /// |sin| of the angle between the free links. At 0 they are in line: the motors
  /// cannot hold the tool, and the jacobian is infinite.
  double transmission = 0.0;
};

/// Below this transmission no force is rendered: torques would grow without bound.
constexpr double kTransmissionMin = 0.1;

/// False where the free links do not meet, or lie in line (transmission below 1e-6).
[[nodiscard]] bool forward(const PantographLinks& links,
                           const Eigen::Vector2d& theta_rad,
                           PantographPose& pose) noexcept;

/// Angles in (-pi, pi] for a position [m]; false where a leg does not reach.
[[nodiscard]] bool inverse(const PantographLinks& links,
                           const Eigen::Vector2d& position_m,
                           Eigen::Vector2d& theta_rad) noexcept;

/// Joint torques [N m] for a force [N] on the tool: jacobian^T F, shrunk together to
/// torque_max_nm so that the direction stays. The torques are zero where the
/// transmission is below kTransmissionMin or the force is not finite.
[[nodiscard]] Eigen::Vector2d torques_for(const PantographPose& pose,
                                          const Eigen::Vector2d& force_n,
                                          double torque_max_nm) noexcept;

/// Force [N] on the tool that torques [N m] make: jacobian^-T torque. The force is zero
/// where no torque makes a force of its own (a driven and a free link in line).
[[nodiscard]] Eigen::Vector2d force_of(const PantographPose& pose,
                                       const Eigen::Vector2d& torque_nm) noexcept;

}  // namespace palpate
