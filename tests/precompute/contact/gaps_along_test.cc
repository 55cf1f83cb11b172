#include "precompute/contact/gaps_along.h"

#include <array>
#include <memory>

#include <gtest/gtest.h>

#include "tests/support/tool_shapes.h"

namespace palpate {
namespace {

constexpr std::array<std::int32_t, 1> kPatch{0};

// A ball of 12 mm, pressed 6 mm along -z at the origin.
IndentationPath path() {
  return {.vertex_m = Eigen::Vector3d::Zero(),
          .outward = Eigen::Vector3d::UnitZ(),
          .tool = std::make_shared<const ToolSurface>(sphere(0.012)),
          .depth_max_m = 0.006};
}

// 5 mm beside the press and 1 mm below the vertex: the ball ends 3.9 mm deeper there.
ContactSurface one_node(const Eigen::Vector3d& normal) {
  ContactNode node;
  node.position_m = {0.005, 0.0, -0.001};
  node.normal = normal.normalized();
  node.gap_points = {{node.position_m, node.normal, 1.0}};
  return {.node = {node}, .of_mesh_node = {}};
}

TEST(GapsAlong, WhatDoesNotFaceTheToolIsNeverMet) {
  const IndentationPath press = path();
  // The ball's normal there: 24.6 degrees from the press.
  const Eigen::Vector3d ball(5.0 / 12.0, 0.0, -std::sqrt(1.0 - 25.0 / 144.0));
  const Eigen::Vector3d across(-ball.z(), 0.0, ball.x());  // looks up as well, and away
  for (const double tilt : {-1e-3, 1e-3}) {
    const ContactSurface surface = one_node(across - tilt * ball);
    const Gaps end = gaps_at(surface, kPatch, press, press.depth_max_m);
    const GapsAlong along(surface, kPatch, press, 0.0);
    if (tilt > 0.0) {
      EXPECT_LT(end.distance_m[0], -1e-3);
      EXPECT_GT(end.by_centre.row(0).dot(press.outward), 0.4);
    } else {
      EXPECT_EQ(end.distance_m[0], 2.0 * press.depth_max_m);
      EXPECT_EQ(end.by_centre.norm(), 0.0);
      EXPECT_EQ(along.at(0.003).distance_m[0], 2.0 * press.depth_max_m);
    }
  }
}

TEST(GapsAlong, AWallThatFacesTheToolIsMetWhereItIsSteeper) {
  const IndentationPath press = path();
  const ContactSurface wall = one_node({-1.0, 0.0, 0.12});
  EXPECT_LT(gaps_at(wall, kPatch, press, press.depth_max_m).distance_m[0], -1e-4);
}

}  // namespace
}  // namespace palpate
