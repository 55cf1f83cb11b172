// Angles between directions.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "formats/base/reproducible.h"

namespace palpate {

/// [rad] [0, pi], accurate at both ends; 0 where either is zero.
inline double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return reproducible::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace palpate
