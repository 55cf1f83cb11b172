#include "precompute/contact/held_obstacle.h"

#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "tests/support/tool_shapes.h"

namespace palpate {
namespace {

constexpr double kRadiusM = 0.005;
constexpr double kDepthM = 0.005;

// A wall in the plane x = 0 with its body behind, from z = 0, where it is held, to 20
// mm; a ball comes along -x.
SurfaceMesh wall() {
  SurfaceMesh mesh;
  mesh.position_m.resize(4, 3);
  mesh.position_m << 0, -0.02, 0, 0, 0.02, 0, 0, 0.02, 0.02, 0, -0.02, 0.02;
  mesh.triangle.resize(2, 3);
  mesh.triangle << 0, 1, 2, 0, 2, 3;
  return mesh;
}

bool is_low(const Eigen::Vector3d& p_m) {
  return p_m.z() <= 0.0;
}

IndentationPath path_at(double height_m) {
  return {.vertex_m = {0.0, 0.0, height_m},
          .outward = Eigen::Vector3d::UnitX(),
          .tool = std::make_shared<const ToolSurface>(sphere(kRadiusM)),
          .depth_max_m = kDepthM};
}

// The ball's centre comes within its radius, less the overlap that is let pass, of the
// held edge, whose points lie 5 mm apart: one of them is right below.
TEST(HeldObstacle, APressEndsWhereTheBallMeetsTheHeldEdgeOfItsWall) {
  const auto held = held_points(wall(), is_low);
  const double height_m = 0.004;
  const double reach_m = kRadiusM - 0.02 * kDepthM;
  const double expected_m =
      kRadiusM - std::sqrt(reach_m * reach_m - height_m * height_m);
  EXPECT_NEAR(depth_until_held_m(held, path_at(height_m)), expected_m, 1e-6);
}

TEST(HeldObstacle, APressOutOfReachOfTheSupportGoesToItsEnd) {
  const auto held = held_points(wall(), is_low);
  EXPECT_EQ(depth_until_held_m(held, path_at(0.006)), kDepthM);
  EXPECT_EQ(depth_until_held_m({}, path_at(0.001)), kDepthM);
}

TEST(HeldObstacle, ATenthOfTheDepthIsLeftCloseToASupport) {
  const auto held = held_points(wall(), is_low);
  EXPECT_DOUBLE_EQ(depth_until_held_m(held, path_at(1e-5)), 0.1 * kDepthM);
}

// The far side of a sheet on a table: the body is between it and the tool.
TEST(HeldObstacle, WhatIsHeldBehindTheBodyIsNotInTheWay) {
  const HeldPoint behind{{-0.001, 0.0, 0.0}, -Eigen::Vector3d::UnitX()};
  const HeldPoint facing{{-0.001, 0.0, 0.0}, Eigen::Vector3d::UnitX()};
  EXPECT_EQ(depth_until_held_m({&behind, 1}, path_at(0.0)), kDepthM);
  EXPECT_LT(depth_until_held_m({&facing, 1}, path_at(0.0)), 0.0013);
}

TEST(HeldObstacle, EveryHeldCornerAndEdgeHasItsPoints) {
  // Two triangles meet at corner 0; one has the held edge with seven points in it.
  EXPECT_EQ(held_points(wall(), is_low).size(), 3u + 7u);
}

}  // namespace
}  // namespace palpate
