// Turns of a tool, and what is none.
#pragma once

#include <limits>

#include <Eigen/Geometry>

namespace palpate {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// @param axis a unit vector
inline Eigen::Quaterniond about(const Eigen::Vector3d& axis, double angle_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis));
}

}  // namespace palpate
