// [[tool]] of shape "spheres", and which tools couple.
#include "formats/scene/scene.h"
#include "tests/formats/scene/scene_text.h"
#include "tests/support/said.h"

namespace palpate {
namespace {

constexpr const char* kThree =
    "shape = \"spheres\"\ncentre_m = [[0, 0, 0], [0.01, 0, 0], [0, 0.01, 0.002]]\n";

TEST(SceneContacts, SpheresShareARadius) {
  const Scene scene =
      read_scene_text(scene_with(kSphere, kThree + std::string("radius_m = 0.003\n")));
  ASSERT_EQ(scene.tool.size(), 1u);
  const ToolShape& tool = scene.tool[0];
  EXPECT_EQ(tool.kind, "sphere");
  EXPECT_EQ(tool.radius_m, 0.003);
  ASSERT_EQ(tool.contact.point_m.rows(), 3);
  EXPECT_EQ(tool.contact.point_m.row(2), Eigen::RowVector3d(0.0, 0.01, 0.002));
  EXPECT_EQ(tool.contact.radius_m, std::vector<double>(3, 0.003));
  EXPECT_TRUE(scene.tool_couples.at(0));
}

TEST(SceneContacts, SpheresOfTwoRadiiArePressedByBoth) {
  const Scene scene = read_scene_text(
      scene_with(kSphere, kThree + std::string("radius_m = [0.003, 0.002, 0.003]\n")));
  ASSERT_EQ(scene.tool.size(), 2u);
  EXPECT_EQ(scene.tool[1].name, scene.tool[0].name + ".2");
  EXPECT_EQ(scene.tool[1].radius_m, 0.002);
  EXPECT_EQ(scene.tool[1].friction, 0.3);
  EXPECT_TRUE(scene.tool[1].contact.empty());
  EXPECT_EQ(scene.tool_couples, std::vector<bool>(2, true));
  EXPECT_EQ(scene.tool_yielding.size(), 2u);
  EXPECT_EQ(scene.tool_mesh.size(), 2u);
}

TEST(SceneContacts, ASphereCouplesIfAsked) {
  const auto couples = [](const std::string& keys) -> bool {
    return read_scene_text(scene_with(kSphere, kSphere + keys)).tool_couples.at(0);
  };
  EXPECT_TRUE(couples("compliance = true\n"));
  EXPECT_FALSE(couples(""));
}

TEST(SceneContacts, SaysWhatIsWrongWithSpheres) {
  const auto refused = [](const std::string& keys) {
    return error_of(scene_with(kSphere, keys));
  };
  const std::string three = kThree;
  expect_says(refused(three + "radius_m = [0.003, 0.002]\n"),
              ("radius_m in [[tool]] has 2 numbers, must have one for "
               "each of the 3 centres, or be one number"));
  expect_says(refused("shape = \"spheres\"\nradius_m = 0.003\n"), ("centre_m"));
  expect_says(refused("shape = \"spheres\"\nradius_m = 0.003\ncentre_m = [0, 0, 0]\n"),
              ("point 0 of centre_m in [[tool]] must have three "
               "coordinates"));
  expect_says(refused("shape = \"spheres\"\nradius_m = 0.003\ncentre_m = []\n"),
              ("must be a list of 1 to 64 points"));
  expect_says(refused("shape = \"spheres\"\nradius_m = 0.003\n"
                      "centre_m = [[0, 0, 0], [0, 0, 0]]\n"),
              ("have one centre, must be apart"));
  expect_says(refused("shape = \"capsule\"\nradius_m = 0.003\nlength_m = 0.01\n"
                      "compliance = true\n"),
              ("compliance"));
}

}  // namespace
}  // namespace palpate
