#include "runtime/served/stiffness_estimate.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/fake_service.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

ServedScene plate_scene(const ToolShape& tool) {
  ServedScene scene = served_scene(sample_database(
      plate(0.1, 2), tool,
      [](Eigen::Index, double d) {
        return 100.0 * d;
      },
      0.01));
  scene.modulus_pa = 5000.0;
  scene.reachable = {0, 4};
  return scene;
}

TEST(HalfSpaceForce, IsThatOfTheTextbooks) {
  ToolShape tool = ball(0.004, 0.0, 0.0);
  EXPECT_NEAR(*half_space_force_n(tool, 9000.0, 0.001), 12000.0 * 2e-6, 1e-12);
  tool.kind = "capsule";
  EXPECT_NEAR(*half_space_force_n(tool, 9000.0, 0.001), 12000.0 * 2e-6, 1e-12);
  tool.kind = "flat-punch";
  EXPECT_NEAR(*half_space_force_n(tool, 9000.0, 0.001), 0.072, 1e-12);
  tool.kind = "cone";
  tool.half_angle_rad = std::numbers::pi / 4.0;
  EXPECT_NEAR(*half_space_force_n(tool, 9000.0, 0.001),
              2.0 / std::numbers::pi * 9000.0 * 1e-6, 1e-12);
  tool.kind = "mesh";
  EXPECT_FALSE(half_space_force_n(tool, 9000.0, 0.001));
}

TEST(EstimatedAnswers, AreOfReachableVerticesAndKnowNoError) {
  const ServedScene scene = plate_scene(ball(0.004, 0.0, 0.0));
  const auto answers = estimated_answers(scene, 0);
  ASSERT_EQ(answers.size(), 2U);
  EXPECT_EQ(answers[1].vertex, 4);
  const NodeResponse& response = answers[1].response;
  EXPECT_EQ(response.error_relative, 1.0);
  EXPECT_NEAR(response.direction.z(), 1.0, 1e-12);
  EXPECT_EQ(response.depth_m.back(), 0.01);
  EXPECT_NEAR(response.force_n.back(),
              4.0 / 3.0 * 5000.0 * std::sqrt(0.004) * std::pow(0.01, 1.5), 1e-12);
}

TEST(EstimatedAnswers, EndWhereTheSceneEndsItsCurves) {
  ServedScene scene = plate_scene(ball(0.004, 0.0, 0.0));
  scene.plan.force_max_n = 0.1;  // of 0.42
  const std::vector<double> force_n =
      estimated_answers(scene, 0).front().response.force_n;
  EXPECT_GT(force_n.back(), 0.1);
  EXPECT_LT(force_n[force_n.size() - 2], 0.1);
}

TEST(EstimatedAnswers, AreNoneWithoutAModulus) {
  ServedScene scene = plate_scene(ball(0.004, 0.0, 0.0));
  scene.modulus_pa = 0.0;
  EXPECT_TRUE(estimated_answers(scene, 0).empty());
}

}  // namespace
}  // namespace palpate
