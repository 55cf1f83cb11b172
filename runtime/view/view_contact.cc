#include "runtime/view/view_contact.h"

#include <cmath>

#include "formats/response/tool_support.h"
#include "formats/response/turn_from_z.h"

namespace palpate {

double drawn_height_m(const ToolShape& tool, const Eigen::Vector3d& outward) {
  const double height_m = height_at_touch_m(tool, outward);
  return std::isfinite(height_m) ? height_m : nominal_height_m(tool);
}

ViewContact view_contact(const ResponseDatabase& database, const ToolShape& tool,
                         const SurfaceSearch& search, const Eigen::Vector3d& x_m,
                         std::int32_t from) {
  const SurfacePoint near = from >= 0 ? search.walk(x_m, from) : search.nearest(x_m);
  ViewContact at{.point_m = near.position_m, .triangle = near.triangle};
  if (near.triangle < 0) {
    return at;
  }
  at.share = near.area_coordinate;
  for (Eigen::Index j = 0; j < 3; ++j) {
    const std::int32_t node = database.body.triangle(near.triangle, j);
    at.node[static_cast<std::size_t>(j)] = node;
    at.normal += at.share(j) * database.normal.row(node).transpose();
  }
  at.normal.normalize();
  if (at.normal.isZero()) {
    return at;  // no response near
  }
  const double height_m = drawn_height_m(tool, at.normal);
  at.penetration_m = height_m - (x_m - at.point_m).dot(at.normal);
  at.over_nominal_m = height_m - nominal_height_m(tool);
  const bool along_normal = tool.kind == "sphere" || !tool.axis;
  at.turn = turn_from_z(along_normal ? at.normal : *tool.axis);
  return at;
}

}  // namespace palpate
