#include "tests/support/tool_shapes.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace palpate {

ToolShape sphere(double radius_m) {
  ToolShape tool;
  tool.name = "sphere";
  tool.radius_m = radius_m;
  return tool;
}

ToolShape flat_punch(double radius_m, double edge_radius_m) {
  ToolShape tool;
  tool.name = "punch";
  tool.kind = "flat-punch";
  tool.radius_m = radius_m;
  tool.edge_radius_m = edge_radius_m;
  return tool;
}

ToolShape cone(double half_angle_rad, double tip_radius_m, double height_m) {
  ToolShape tool;
  tool.name = "cone";
  tool.kind = "cone";
  tool.half_angle_rad = half_angle_rad;
  tool.tip_radius_m = tip_radius_m;
  tool.length_m = height_m;
  return tool;
}

ToolShape capsule(double radius_m, double length_m) {
  ToolShape tool;
  tool.name = "capsule";
  tool.kind = "capsule";
  tool.radius_m = radius_m;
  tool.length_m = length_m;
  return tool;
}

ToolShape box_tool(const Eigen::Vector3d& sides_m) {
  ToolShape tool = mesh_tool("box", {});
  tool.mesh.position_m.resize(8, 3);
  for (int v = 0; v < 8; ++v) {
    tool.mesh.position_m.row(v) << ((v & 1) != 0 ? 0.5 : -0.5) * sides_m.x(),
        ((v & 2) != 0 ? 0.5 : -0.5) * sides_m.y(), ((v & 4) != 0 ? sides_m.z() : 0.0);
  }
  tool.mesh.triangle.resize(12, 3);
  tool.mesh.triangle << 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7,
      2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5;
  return tool;
}

ToolShape mesh_tool(const std::string& name, SurfaceMesh mesh) {
  ToolShape tool;
  tool.name = name;
  tool.kind = "mesh";
  tool.mesh = std::move(mesh);
  return tool;
}

SurfaceMesh upturned_pyramid(int sides, double radius_m, double height_m) {
  SurfaceMesh mesh;
  mesh.position_m.resize(sides + 2, 3);
  mesh.position_m.row(sides).setZero();
  mesh.position_m.row(sides + 1) << 0.0, 0.0, height_m;
  mesh.triangle.resize(2 * sides, 3);
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    mesh.position_m.row(i) << radius_m * std::cos(angle), radius_m * std::sin(angle),
        height_m;
    const int next = (i + 1) % sides;
    mesh.triangle.row(2 * i) << sides, next, i;
    mesh.triangle.row(2 * i + 1) << sides + 1, i, next;
  }
  return mesh;
}

SurfaceMesh prism(int sides, double radius_m, double height_m) {
  SurfaceMesh mesh;
  mesh.position_m.resize(2 * sides + 2, 3);
  mesh.position_m.bottomRows(2) << 0.0, 0.0, 0.0, 0.0, 0.0, height_m;
  mesh.triangle.resize(4 * sides, 3);
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    for (const int top : {0, 1}) {
      mesh.position_m.row(2 * i + top) << radius_m * std::cos(angle),
          radius_m * std::sin(angle), top * height_m;
    }
    const int low = 2 * i;
    const int next = 2 * ((i + 1) % sides);
    mesh.triangle.row(4 * i) << 2 * sides, next, low;
    mesh.triangle.row(4 * i + 1) << 2 * sides + 1, low + 1, next + 1;
    mesh.triangle.row(4 * i + 2) << low, next, next + 1;
    mesh.triangle.row(4 * i + 3) << low, next + 1, low + 1;
  }
  return mesh;
}

}  // namespace palpate
