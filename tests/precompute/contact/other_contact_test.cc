#include "precompute/contact/other_contact.h"

#include <memory>

#include <gtest/gtest.h>

#include "tests/support/tool_shapes.h"

namespace palpate {
namespace {

// A ball of 5 mm, pressed 2 mm along -z at the origin: in the end it spans z from -2 to
// 8 mm, and reaches 5 mm to the side at z = 3 mm. Overlaps below 0.2 mm do not count.
const IndentationPath kPath{.vertex_m = Eigen::Vector3d::Zero(),
                            .outward = Eigen::Vector3d::UnitZ(),
                            .tool = std::make_shared<const ToolSurface>(sphere(0.005)),
                            .depth_max_m = 0.002};

ContactSurface node_at(const Eigen::Vector3d& position_mm,
                       const Eigen::Vector3d& normal) {
  ContactNode node;
  node.position_m = 1e-3 * position_mm;
  node.normal = normal;
  return {.node = {node}, .of_mesh_node = {}};
}

bool is_met(const Eigen::Vector3d& position_mm, const Eigen::Vector3d& normal,
            double touch_m = 0.0) {
  return reaches_elsewhere(node_at(position_mm, normal), {}, kPath, touch_m);
}

TEST(OtherContact, AWallBesideTheBallIsMetWhereItLiesInTheBallInTheEnd) {
  const Eigen::Vector3d faces_ball = -Eigen::Vector3d::UnitX();
  EXPECT_TRUE(is_met({4.7, 0.0, 3.0}, faces_ball));
  EXPECT_FALSE(is_met({4.9, 0.0, 3.0}, faces_ball));  // by 0.1 mm
  EXPECT_FALSE(is_met({5.1, 0.0, 3.0}, faces_ball));
}

TEST(OtherContact, WhatFacesAwayCountsOnlyIfItIsInTheToolFromTheFirstTouch) {
  // The far side of a sheet of 1 mm: passed on the way, no obstacle.
  EXPECT_FALSE(is_met({0.0, 0.0, -1.0}, -Eigen::Vector3d::UnitZ()));
  // A lobe that hangs over the vertex: the ball stands in it before it presses.
  EXPECT_TRUE(is_met({0.0, 0.0, 6.0}, Eigen::Vector3d::UnitZ()));
}

TEST(OtherContact, APressThatTouchesEarlyStartsThere) {
  // In the ball at its vertex, but 3 mm higher, where this press begins, not yet.
  EXPECT_TRUE(is_met({0.0, 0.0, 2.5}, -Eigen::Vector3d::UnitZ(), 0.0));
  EXPECT_FALSE(is_met({0.0, 0.0, 2.5}, -Eigen::Vector3d::UnitZ(), -0.003));
}

TEST(OtherContact, NodesOfThePatchAreKnown) {
  const ContactSurface surface = node_at({0.0, 0.0, 0.0}, Eigen::Vector3d::UnitZ());
  const std::int32_t known[] = {0};
  EXPECT_TRUE(reaches_elsewhere(surface, {}, kPath, 0.0));
  EXPECT_FALSE(reaches_elsewhere(surface, known, kPath, 0.0));
}

}  // namespace
}  // namespace palpate
