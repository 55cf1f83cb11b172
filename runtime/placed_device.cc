#include "runtime/placed_device.h"

#include <cmath>

#include <Eigen/Geometry>

namespace palpate {

Placement placement_over(const HandScript& script, const Eigen::Vector3d& centre_m) {
  const Eigen::Vector3d y = script.normal.normalized();
  Eigen::Vector3d across = Eigen::Vector3d::UnitX();
  if (std::abs(y.x()) > 0.9) {
    across = Eigen::Vector3d::UnitY();
  }
  const Eigen::Vector3d z = across.cross(y).normalized();
  Placement placement{
      .origin_m = script.surface_m + (script.touch_m + script.clear_m) * y,
      .centre_m = centre_m};
  placement.rotation << y.cross(z), y, z;
  return placement;
}

HandScript in_device_frame(const HandScript& script, const Placement& placement) {
  HandScript moved = script;
  moved.surface_m = placement.to_device(script.surface_m);
  moved.normal = placement.rotation.transpose() * script.normal;
  return moved;
}

}  // namespace palpate
