// The least turn that takes z to a direction: how tools stand along an axis.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace palpate {

/// @param along of any length but zero. Along -z, where no turn is the least: half a
/// turn about x.
[[nodiscard]] Eigen::Quaterniond turn_from_z(const Eigen::Vector3d& along);

}  // namespace palpate
