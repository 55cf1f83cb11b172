// The axes of Haply's Inverse3, over USB and from its service.
#pragma once

#include <Eigen/Core>

namespace palpate {

/// Theirs: x right, y away from the person, z up. Ours, as of every device here: y up,
/// z towards the person.
[[nodiscard]] inline Eigen::Vector3d from_haply(const Eigen::Vector3d& v) noexcept {
  return {v.x(), v.z(), -v.y()};
}
[[nodiscard]] inline Eigen::Vector3d to_haply(const Eigen::Vector3d& v) noexcept {
  return {v.x(), -v.z(), v.y()};
}

}  // namespace palpate
