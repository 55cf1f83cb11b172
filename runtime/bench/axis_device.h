// A haptic device on one axis, for benches: a mass that carries a Maxwell load.
//
// Symbols: x position [m], v velocity [m/s], m force of the load [N], F input [N].
//
//   M v' = F - b v - m,   m' = K v - (K / B) m
//
// The input is constant during a tick (zero-order hold), so a tick is the exact matrix
// exponential of the system. The step does not limit the accuracy.
#pragma once

#include <Eigen/Core>

namespace palpate {

/// The defaults are the virtual PenCat. With them the largest stable stiffness of a
/// plain sampled wall follows the single-thread column of the paper's Table 1.
struct VirtualDeviceOptions {
  double mass_kg = 0.12;                ///< [kg] > 0, M
  double damping_n_s_per_m = 0.0;       ///< [N s/m] >= 0, b, to ground
  double load_n_per_m = 12.0;           ///< [N/m] >= 0, K, spring of the load
  double load_damping_n_s_per_m = 1.8;  ///< [N s/m] > 0, B, in series with K
};

class VirtualDevice {
 public:
  /// @param tick_s [s] > 0. @throws InputError naming the value that is out of range.
  VirtualDevice(const VirtualDeviceOptions& options, double tick_s);

  [[nodiscard]] double position_m() const { return state_(0); }
  [[nodiscard]] double velocity_m_per_s() const { return state_(1); }
  void set_position_m(double x) { state_(0) = x; }
  void kick(double velocity_m_per_s) { state_(1) += velocity_m_per_s; }

  /// One tick under a constant force [N].
  void step(double force_n) { state_ = transition_ * state_ + input_ * force_n; }

 private:
  Eigen::Matrix3d transition_;
  Eigen::Vector3d input_;
  Eigen::Vector3d state_ = Eigen::Vector3d::Zero();  // x, v, m
};

}  // namespace palpate
