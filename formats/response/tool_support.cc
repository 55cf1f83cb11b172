#include "formats/response/tool_support.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "formats/base/reproducible.h"
#include "formats/response/turn_from_z.h"

namespace palpate {
namespace {

// An endless edge across the direction ends there, whatever rounding says.
constexpr double kAcross = 1e-12;

// Largest of x . d over the tool, d a unit vector in the tool's frame.
double support_m(const ToolShape& tool, const Eigen::Vector3d& d) {
  // The tool's axis is +z. Its origin is the lowest point of a punch or cone, the lower
  // centre of a capsule, a sphere's centre. across is the part of d across the axis.
  const double across = std::hypot(d.x(), d.y());
  if (tool.kind == "mesh") {
    return tool.mesh.position_m.lazyProduct(d).maxCoeff();
  }
  if (tool.kind == "capsule") {
    return tool.radius_m + std::max(0.0, tool.length_m * d.z());
  }
  if (tool.kind == "flat-punch") {
    // Punch: a torus of radii R - e and e around height e; endless upwards.
    const double edge = tool.edge_radius_m;
    return d.z() > kAcross ? std::numeric_limits<double>::infinity()
                           : (tool.radius_m - edge) * across + edge * d.z() + edge;
  }
  if (tool.kind == "cone") {
    // Cone: the tip's sphere around height r, and the flank. The flank has the length L
    // / cos(half angle) and rises by d . (sin, cos) of the half angle.
    const double tip = tool.tip_radius_m * (1.0 + d.z());
    const double rise = reproducible::sin(tool.half_angle_rad) * across +
                        reproducible::cos(tool.half_angle_rad) * d.z();
    if (!(rise > kAcross)) {
      return tip;
    }
    const double flank_m = tool.length_m / reproducible::cos(tool.half_angle_rad);
    return tool.length_m > 0.0 ? tip + flank_m * rise
                               : std::numeric_limits<double>::infinity();
  }
  return tool.radius_m;
}

}  // namespace

double height_at_touch_m(const ToolShape& tool, const Eigen::Vector3d& outward) {
  if (tool.kind == "sphere" || !tool.axis) {
    return support_m(tool, -Eigen::Vector3d::UnitZ());
  }
  const Eigen::Quaterniond turn = turn_from_z(*tool.axis);
  return support_m(tool, -(turn.conjugate() * outward));
}

double nominal_height_m(const ToolShape& tool) {
  return std::max(0.0, support_m(tool, -Eigen::Vector3d::UnitZ()));
}

}  // namespace palpate
