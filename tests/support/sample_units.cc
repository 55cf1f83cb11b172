#include "tests/support/sample_units.h"

#include <cmath>

#include "tests/support/small_database.h"

namespace palpate {
namespace {

WorkUnitNode hertzian(std::int32_t vertex, double stiffness) {
  WorkUnitNode node{.tool = 0, .vertex = vertex, .response = {}, .failure = {}};
  NodeResponse& response = node.response;
  response.direction = (octahedron(0.02).position_m.row(vertex).transpose() +
                        Eigen::Vector3d(0, 0, 1e-4))
                           .normalized();
  response.direction_spread_rad = 0.01 + 0.001 * vertex;
  response.touch_offset_m = -1e-5 * vertex;
  for (int k = 0; k <= 8; ++k) {
    const double depth_m = 0.003 * k / 8;
    response.depth_m.push_back(depth_m);
    response.force_n.push_back(stiffness * depth_m * std::sqrt(depth_m));
  }
  response.error_relative = 0.01 * (vertex + 1);
  response.origin = ResponseOrigin::kSimulated;
  return node;
}

}  // namespace

JobDescription sample_plan() {
  JobDescription plan{.digest = "0123abcd",
                      .units = 3,
                      .body = octahedron(0.02),
                      .normal = {},
                      .tool = {{.name = "tip",
                                .kind = "cone",
                                .friction = 0.3,
                                .presliding_m = 5e-4,
                                .half_angle_rad = 0.5,
                                .tip_radius_m = 1e-3,
                                .length_m = 0.02,
                                .axis = Eigen::Vector3d(0.6, 0.0, 0.8),
                                .sticking = true}},
                      .force_relative = 0.05,
                      .reachable = 5,
                      .depth_max_m = 0.003,
                      .force_max_n = 7.5,
                      .provenance = {.writer = "palpate-precompute 0.0",
                                     .scene_toml = "# Umlaute: \xc3\xa4\n[body]\n",
                                     .source_file = "body.obj",
                                     .source_sha256 = std::string(64, 'a'),
                                     .left_out = {}}};
  plan.normal = plan.body.position_m.rowwise().normalized();
  return plan;
}

std::vector<WorkUnitOutcome> sample_units() {
  WorkUnitNode interpolated = hertzian(2, 900.0);
  interpolated.response.origin = ResponseOrigin::kInterpolated;
  interpolated.response.error_relative = 0.08;
  interpolated.response.flags = kErrorOverBudget;
  WorkUnitNode partial = hertzian(3, 800.0);
  partial.failure = "no equilibrium at 2.5 mm";
  partial.history = "failed: mesh 2 times coarser, every depth, stiff contact";
  WorkUnitNode failed{
      .tool = 0, .vertex = 4, .response = {}, .failure = "meshing failed"};
  failed.response.flags = kFailed;
  WorkUnitNode check = hertzian(0, 1000.0);
  for (double& force_n : check.response.force_n) {
    force_n *= 1.1;
  }
  return {{.index = 0,
           .is_check = false,
           .node = {hertzian(0, 1000.0), hertzian(1, 1200.0), interpolated}},
          {.index = 1, .is_check = false, .node = {partial, failed}},
          {.index = 2, .is_check = true, .node = {check}}};
}

}  // namespace palpate
