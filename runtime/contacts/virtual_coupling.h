// A tool with mass and inertia between a device and what is rendered: for devices that
// actuate fewer axes than they sense, or by choice.
//
// The tool body has mass m, inertia J in its frame, pose p, R, velocity v, and spin W
// in its frame. The body is held at the device's pose (p_d, R_d) by
//
//   U_c = k_t |p - p_d|^2 / 2 + k_r (3 - tr R_d^T R) / 2
//
// and dampers b_t, b_r on the relative velocities, and lies in a potential U of its
// pose. A tick of h, after the device has moved (work on the spring, the tool frozen):
//
//   dp = h (v0 + v1) / 2,      R1 = R0 cay(h (W0 + W1) / 2)
//   m (v1 - v0) = h F,         R1 J W1 - R0 J W0 = h T          (Simo & Wong 1991)
//   (F, T) = wrench of U + U_c at the middle pose + a (dp, L^2 th),   th = h R0 W_mid
//
// a such that F . dp + T . th = -(change of U + U_c): a discrete gradient. Cayley's map
// leaves W_mid where it is, so that th . (R1 J W1 - R0 J W0) is h times the change of
// kinetic energy, and at the end of the fixed point
//
//   work = change of (kinetic + U_c + U) + dissipated
//
// to rounding, for every U and h; what is left is in residual_j. Without forces
// momentum is kept exactly, energy to rounding.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "runtime/account/real.h"
#include "runtime/contacts/coupled_model.h"
#include "runtime/contacts/coupled_set.h"

namespace palpate {

struct VirtualCoupling {
  Real mass_kg = 0.1;                               ///< [kg] > 0
  Vector3 inertia_kg_m2 = Vector3::Constant(2e-5);  ///< [kg m^2] > 0, principal
  Real spring_n_per_m = 1500.0;                     ///< k_t >= 0
  Real spring_n_m_per_rad = 0.6;                    ///< k_r >= 0
  Real damper_n_s_per_m = 6.0;                      ///< b_t >= 0
  Real damper_n_m_s = 2e-3;                         ///< b_r >= 0
  Real lever_m = 0.03;                              ///< [m] L > 0
};

/// Null if valid, else what is wrong, one line.
[[nodiscard]] const char* check(const VirtualCoupling& coupling) noexcept;

/// The tool body. Its rotation is a unit quaternion, its spin follows from its angular
/// momentum, so that neither drifts.
struct VirtualBody {
  Vector3 position_m = Vector3::Zero();
  Eigen::Quaternion<Real> turn = Eigen::Quaternion<Real>::Identity();
  Vector3 velocity_m_per_s = Vector3::Zero();
  Vector3 momentum_n_m_s = Vector3::Zero();  ///< R J W, in the body's frame

  [[nodiscard]] PortPose pose() const noexcept {
    return {position_m, turn.toRotationMatrix()};
  }
};

/// Where the device is, and how it got there since the last tick.
struct DevicePose {
  Vector3 position_m = Vector3::Zero();
  Eigen::Quaternion<Real> turn = Eigen::Quaternion<Real>::Identity();
  Vector3 velocity_m_per_s = Vector3::Zero();  ///< in the tick, for the dampers
  Vector3 spin_rad_per_s = Vector3::Zero();    ///< in the world's frame, likewise
};

/// U, with the wrench that is its gradient's negative. Neither throws.
struct PosePotential {
  void* of = nullptr;
  /// Energy [J]; the wrench about the reference point where that is not null.
  Real (*energy_j)(void* of, const PortPose& pose, Wrench* wrench) = nullptr;
};

/// The account of one tick.
struct VirtualTick {
  double work_j = 0.0;        ///< of the user: on the spring, and on the dampers
  double dissipated_j = 0.0;  ///< >= 0 by the dampers
  double potential_j = 0.0;   ///< U after the tick
  double residual_j = 0.0;    ///< of the identity: the solver's
  int iterations = 0;
  Wrench on_device;  ///< of spring and dampers, for the next hold
};

[[nodiscard]] Real kinetic_j(const VirtualCoupling& coupling,
                             const VirtualBody& body) noexcept;

/// U_c.
[[nodiscard]] Real spring_j(const VirtualCoupling& coupling, const VirtualBody& body,
                            const DevicePose& device) noexcept;

/// One tick of h_s > 0. @param before the device in the tick before. Bounded: at most
/// kVirtualIterationsMax evaluations of U in the middle and at the end.
VirtualTick advance(const VirtualCoupling& coupling, VirtualBody& body,
                    const DevicePose& before, const DevicePose& device,
                    const PosePotential& potential, Real h_s) noexcept;

constexpr int kVirtualIterationsMax = 60;

}  // namespace palpate
