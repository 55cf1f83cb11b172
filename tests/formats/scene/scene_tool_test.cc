// Tools, accuracy and drawing of scenes.
#include <numbers>

#include <fmt/format.h>

#include "formats/scene/scene.h"
#include "tests/formats/scene/scene_text.h"

namespace palpate {
namespace {

ToolShape tool_of(const std::string& keys) {
  return read_scene_text(scene_with(kSphere, keys)).tool.at(0);
}

TEST(SceneTool, APunchHasAnEdge) {
  const ToolShape punch =
      tool_of("shape = \"flat-punch\"\nradius_m = 0.004\nedge_radius_m = 0.0002\n");
  EXPECT_EQ(punch.kind, "flat-punch");
  EXPECT_EQ(punch.radius_m, 0.004);
  EXPECT_EQ(punch.edge_radius_m, 0.0002);
}

TEST(SceneTool, AConeHasAHalfAngleAndATip) {
  const ToolShape cone =
      tool_of("shape = \"cone\"\nhalf_angle_deg = 30\ntip_radius_m = 0.0001\n");
  EXPECT_NEAR(cone.half_angle_rad, std::numbers::pi / 6.0, 1e-15);
  EXPECT_EQ(cone.tip_radius_m, 0.0001);
  EXPECT_EQ(cone.length_m, 0.0);
  EXPECT_EQ(cone.radius_m, 0.0);
}

TEST(SceneTool, ACapsuleHasALength) {
  const ToolShape capsule = tool_of(
      "shape = \"capsule\"\nradius_m = 0.004\nlength_m = 0.02\naxis = [0, 0, 5]\n");
  EXPECT_EQ(capsule.length_m, 0.02);
  ASSERT_TRUE(capsule.axis.has_value());
  EXPECT_EQ(*capsule.axis, Eigen::Vector3d(0.0, 0.0, 1.0));
}

TEST(SceneTool, AMeshIsNamedBesideItsTool) {
  const Scene scene = read_scene_text(scene_with(
      kSphere, "shape = \"mesh\"\nmesh = \"tip.stl\"\nlength_unit = \"mm\"\n"));
  EXPECT_EQ(scene.tool[0].kind, "mesh");
  ASSERT_EQ(scene.tool_mesh.size(), 1u);
  EXPECT_EQ(scene.tool_mesh[0].file, scene.mesh.parent_path() / "tip.stl");
  EXPECT_EQ(scene.tool_mesh[0].length_unit, "mm");
  EXPECT_TRUE(read_scene_text(kScene).tool_mesh.at(0).file.empty());
}

TEST(SceneTool, SticksIfAsked) {
  const std::string sphere = kSphere;
  EXPECT_TRUE(tool_of(sphere + "contact = \"sticking\"\n").sticking);
  EXPECT_FALSE(tool_of(sphere + "contact = \"frictionless\"\n").sticking);
}

constexpr const char* kBudget = "force_relative = 0.04\ncontact_resolution = 3\n";

TEST(SceneAccuracy, ReadsEveryKey) {
  const Scene scene = read_scene_text(
      scene_with(kBudget,
                 "contact_resolution = 0\ndepths = 64\nmethod = \"nonlinear\"\n"
                 "refine = \"local\"\nsolve = \"all\"\nverify = 0\n"));
  EXPECT_EQ(scene.contact_resolution, 0.0);
  EXPECT_EQ(scene.accuracy.depths, 64);
  EXPECT_EQ(scene.accuracy.method, "nonlinear");
  EXPECT_EQ(scene.accuracy.refine, "local");
  EXPECT_EQ(scene.accuracy.solve, "all");
  EXPECT_EQ(scene.accuracy.verify, 0);
}

TEST(SceneDrawing, ReadsEveryKey) {
  const Scene scene = read_scene_text(fmt::format(
      "{}\n[drawing]\ndisplacement = true\nerror_relative = 0.1\n", kScene));
  EXPECT_TRUE(scene.drawing.displacement);
  EXPECT_EQ(scene.drawing.error_relative, 0.1);
}

class SceneToolMistake : public SceneMistakeTest {};

TEST_P(SceneToolMistake, IsNamedWithItsLine) {
  expect_named(GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, SceneToolMistake,
    testing::Values(
        Mistake{
            kSphere, "shape = \"cone\"\nradius_m = 0.005\nhalf_angle_deg = 30\n",
            ":18: \"radius_m\" in [[tool]] does not belong to shape \"cone\", which "
            "has: half_angle_deg, tip_radius_m, length_m"},
        Mistake{kSphere, "shape = \"cone\"\nhalf_angle_deg = 90\n",
                ":18: half_angle_deg in [[tool]] is 90, must be above 0 and below 90"},
        Mistake{kSphere,
                "shape = \"flat-punch\"\nradius_m = 0.001\nedge_radius_m = 0.002\n",
                ":15: tool \"ball\": edge_radius_m"},
        Mistake{kSphere, "shape = \"capsule\"\nradius_m = 0.001\n",
                ":15: [[tool]] needs the key \"length_m\""},
        Mistake{kSphere, "shape = \"mesh\"\nmesh = \"tip.stl\"\n",
                ":15: [[tool]] needs the key \"length_unit\""},
        Mistake{kSphere,
                "shape = \"mesh\"\nmesh = \"tip.stl\"\nlength_unit = \"mile\"\n",
                ":19: length_unit in [[tool]]: unknown length"},
        Mistake{"radius_m = 0.005\n", "radius_m = 0.005\naxis = [0, 0, 0]\n",
                ":19: axis in [[tool]] is [0, 0, 0], must have a direction"},
        Mistake{"radius_m = 0.005\n", "radius_m = 0.005\ncontact = \"glued\"\n",
                ":19: contact \"glued\" in [[tool]] is not available; available: "
                "frictionless, sticking"},
        Mistake{"radius_m = 0.005\n", "radius_m = 0.005\nedge_radus_m = 0\n",
                ":19: unknown key \"edge_radus_m\" in [[tool]]; the nearest known one "
                "is \"edge_radius_m\""}));

INSTANTIATE_TEST_SUITE_P(
    Budgets, SceneToolMistake,
    testing::Values(
        Mistake{kBudget, "depths = 1\n",
                ":28: depths in [accuracy] is 1, must be in [2, 64]"},
        Mistake{kBudget, "depths = 65\n", ":28: depths in [accuracy] is 65"},
        Mistake{kBudget, "depths = 20.0\n",
                ":28: depths in [accuracy] must be a whole number in [2, 64]"},
        Mistake{kBudget, "method = \"newton\"\n",
                ":28: method \"newton\" in [accuracy] is not available; available: "
                "auto, linear, nonlinear"},
        Mistake{kBudget, "refine = \"none\"\n",
                ":28: refine \"none\" in [accuracy] is not available; available: auto, "
                "global, local"},
        Mistake{kBudget, "solve = \"some\"\n",
                ":28: solve \"some\" in [accuracy] is not available; available: auto, "
                "all"},
        Mistake{kBudget, "verify = -1\n", ":28: verify in [accuracy] is -1"},
        Mistake{kBudget, "verifi = 1\n",
                ":28: unknown key \"verifi\" in [accuracy]; the nearest known one is "
                "\"verify\""},
        Mistake{kBudget, "[drawing]\ndisplacement = 1\n",
                ":29: displacement in [drawing] is a number, must be true or false"},
        Mistake{kBudget, "[drawing]\nerror_relative = 0\n",
                ":29: error_relative in [drawing] is 0, must be above 0 and below 1"},
        Mistake{kBudget, "[drawing]\ndisplacements = true\n",
                ":29: unknown key \"displacements\" in [drawing]; the nearest known "
                "one is \"displacement\""}));

}  // namespace
}  // namespace palpate
