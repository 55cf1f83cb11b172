#include "runtime/attach/placed_device.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {

Placement placement_over(const HandScript& script, const Eigen::Vector3d& centre_m,
                         const Eigen::Vector3d& right) {
  constexpr double kAlong = 0.9;  // nearer to the normal it says no direction across
  const Eigen::Vector3d y = script.normal.normalized();
  const auto is_along = [&y](const Eigen::Vector3d& v) {
    return std::abs(y.dot(v)) > kAlong;
  };
  Eigen::Vector3d across = right.normalized();
  if (right.isZero() || is_along(across)) {
    across = is_along(Eigen::Vector3d::UnitX()) ? Eigen::Vector3d::UnitY()
                                                : Eigen::Vector3d::UnitX();
  }
  const Eigen::Vector3d z = across.cross(y).normalized();
  Placement placement{
      .origin_m = script.surface_m + (script.touch_m + script.clear_m) * y,
      .centre_m = centre_m};
  placement.rotation << y.cross(z), y, z;
  return placement;
}

SectionPlane parse_plane(const std::string& text) {
  SectionPlane plane;
  const std::size_t axis =
      text.empty() ? std::string::npos : std::string("xyz").find(text[0]);
  const char* const begin = text.data() + std::min<std::size_t>(2, text.size());
  const char* const end = text.data() + text.size();
  const auto [last, error] = std::from_chars(begin, end, plane.offset_m);
  if (axis == std::string::npos || text[1] != '=' || error != std::errc() ||
      last != end || !std::isfinite(plane.offset_m)) {
    throw InputError(fmt::format(
        "--plane {}: must be x=, y= or z= and a distance [m], as x=0.01", text));
  }
  plane.axis = static_cast<int>(axis);
  return plane;
}

Placement placement_in(const SectionPlane& plane, const HandScript& script,
                       const Eigen::Vector3d& centre_m) {
  const Eigen::Vector3d z = Eigen::Vector3d::Unit(plane.axis);
  const Eigen::Vector3d normal = script.normal.normalized();
  const Eigen::Vector3d in_plane = normal - normal.dot(z) * z;
  if (!(in_plane.norm() > 0.5)) {
    throw InputError(fmt::format(
        "--plane {}={}: the surface's normal at the pressed node, ({:.3g}, {:.3g}, "
        "{:.3g}), must be within 60 degrees of the plane",
        "xyz"[plane.axis], plane.offset_m, normal.x(), normal.y(), normal.z()));
  }
  const Eigen::Vector3d y = in_plane.normalized();
  Placement placement{
      .origin_m = script.surface_m + (script.touch_m + script.clear_m) * y,
      .centre_m = centre_m};
  placement.origin_m[plane.axis] = plane.offset_m;
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
