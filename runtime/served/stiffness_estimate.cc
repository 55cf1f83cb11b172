#include "runtime/served/stiffness_estimate.h"

#include <cmath>
#include <numbers>

namespace palpate {

std::optional<double> half_space_force_n(const ToolShape& tool, double modulus_pa,
                                         double depth_m) {
  if (tool.kind == "sphere" || tool.kind == "capsule") {
    return 4.0 / 3.0 * modulus_pa * std::sqrt(tool.radius_m) * std::pow(depth_m, 1.5);
  }
  if (tool.kind == "flat-punch") {
    return 2.0 * modulus_pa * tool.radius_m * depth_m;
  }
  if (tool.kind == "cone") {
    return 2.0 / std::numbers::pi * modulus_pa * std::tan(tool.half_angle_rad) *
           depth_m * depth_m;
  }
  return std::nullopt;
}

std::vector<WorkUnitNode> estimated_answers(const ServedScene& scene,
                                            std::int32_t tool) {
  constexpr int kDepths = 20;
  const JobDescription& plan = scene.plan;
  const ToolShape& shape = plan.tool[static_cast<std::size_t>(tool)];
  NodeResponse response;
  for (int i = 0; i <= kDepths; ++i) {
    const double depth_m = plan.depth_max_m * i / kDepths;
    const auto force_n = half_space_force_n(shape, scene.modulus_pa, depth_m);
    if (!force_n || scene.modulus_pa <= 0.0) {
      return {};
    }
    response.depth_m.push_back(depth_m);
    response.force_n.push_back(*force_n);
    // The first sample past the scene's force ends the curve.
    if (*force_n > plan.force_max_n) {
      break;
    }
  }
  // Straight out of the surface, of the same force at every vertex.
  response.origin = ResponseOrigin::kInterpolated;
  response.error_relative = 1.0;
  std::vector<WorkUnitNode> answers;
  for (const std::int32_t vertex : scene.reachable) {
    response.direction = plan.normal.row(vertex).transpose();
    answers.push_back({.tool = tool, .vertex = vertex, .response = response});
  }
  return answers;
}

}  // namespace palpate
