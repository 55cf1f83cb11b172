// How a body stands in its host's world.
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "runtime/contacts/coupled_model.h"

namespace palpate {

/// x_world = turn x_body + origin; until it is placed, the world's frame is the body's,
/// bit for bit.
class BodyPlacement {
 public:
  /// @param quaternion x y z w, of any length but 0. False, and nothing happens: what
  /// is not finite, or no orientation.
  bool place(const Eigen::Vector3d& origin_m, const Eigen::Vector4d& quaternion) {
    const double length = quaternion.stableNorm();
    if (!origin_m.allFinite() || !(length > 0.0) || !std::isfinite(length)) {
      return false;
    }
    placed_ = true;
    turn_ = Eigen::Quaterniond(Eigen::Vector4d(quaternion / length));
    rotation_ = turn_.toRotationMatrix();
    origin_m_ = origin_m;
    return true;
  }

  [[nodiscard]] Eigen::Vector3d point_in_body(const Eigen::Vector3d& x_m) const {
    return placed_ ? Eigen::Vector3d(rotation_.transpose() * (x_m - origin_m_)) : x_m;
  }
  [[nodiscard]] Eigen::Vector3d point_in_world(const Eigen::Vector3d& x_m) const {
    return placed_ ? Eigen::Vector3d(rotation_ * x_m + origin_m_) : x_m;
  }
  /// Of a force, torque or normal.
  [[nodiscard]] Eigen::Vector3d vector_in_body(const Eigen::Vector3d& v) const {
    return placed_ ? Eigen::Vector3d(rotation_.transpose() * v) : v;
  }
  [[nodiscard]] Eigen::Vector3d vector_in_world(const Eigen::Vector3d& v) const {
    return placed_ ? Eigen::Vector3d(rotation_ * v) : v;
  }
  [[nodiscard]] Wrench in_body(const Wrench& w) const {
    return {vector_in_body(w.force_n), vector_in_body(w.torque_n_m)};
  }
  [[nodiscard]] Wrench in_world(const Wrench& w) const {
    return {vector_in_world(w.force_n), vector_in_world(w.torque_n_m)};
  }
  /// Of a tool, x y z w; zeros, which are none, lie along the frame that it is given
  /// in.
  [[nodiscard]] Eigen::Vector4d turn_in_body(const Eigen::Vector4d& quaternion) const {
    if (!placed_) {
      return quaternion;
    }
    const Eigen::Quaterniond turn(
        quaternion.isZero(0.0) ? Eigen::Vector4d(0.0, 0.0, 0.0, 1.0) : quaternion);
    return (turn_.conjugate() * turn).coeffs();
  }

 private:
  bool placed_ = false;
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d rotation_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate
