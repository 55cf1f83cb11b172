// Tools of every kind, for tests.
#pragma once

#include <string>

#include <Eigen/Core>

#include "formats/response/tool_shape.h"

namespace palpate {

[[nodiscard]] ToolShape sphere(double radius_m);
[[nodiscard]] ToolShape flat_punch(double radius_m, double edge_radius_m);
[[nodiscard]] ToolShape cone(double half_angle_rad, double tip_radius_m,
                             double height_m = 0.0);
[[nodiscard]] ToolShape capsule(double radius_m, double length_m);

/// A box with the middle of its lower face at the origin: 8 vertices, 12 triangles.
[[nodiscard]] ToolShape box_tool(const Eigen::Vector3d& sides_m);

[[nodiscard]] ToolShape mesh_tool(const std::string& name, SurfaceMesh mesh);

/// A pyramid that stands on its tip, the origin, along z: corners at radius_m from the
/// axis at height_m. @param sides >= 3.
[[nodiscard]] SurfaceMesh upturned_pyramid(int sides, double radius_m, double height_m);

/// A prism upwards from z = 0: corners at radius_m from the axis. @param sides >= 3.
[[nodiscard]] SurfaceMesh prism(int sides, double radius_m, double height_m);

}  // namespace palpate
