#include "formats/scene/scene.h"

#include "formats/base/error.h"
#include "tests/formats/scene/scene_text.h"

namespace palpate {
namespace {

TEST(Scene, ReadsEveryKey) {
  const ScratchFolder folder;
  std::ofstream(folder / "scene.toml") << kScene;
  const Scene scene = read_scene(folder / "scene.toml");
  EXPECT_EQ(scene.mesh, folder / "liver.obj");
  EXPECT_EQ(scene.length_unit, "cm");
  ASSERT_EQ(scene.material.size(), 1u);
  EXPECT_EQ(scene.material[0].youngs_modulus_pa, 5000.0);
  EXPECT_EQ(scene.material[0].poissons_ratio, 0.45);
  ASSERT_EQ(scene.support.size(), 1u);
  ASSERT_TRUE(scene.support[0].box_m.has_value());
  EXPECT_EQ(scene.support[0].box_m->max(), Eigen::Vector3d(1.0, 1.0, -0.0199));
  ASSERT_EQ(scene.tool.size(), 1u);
  EXPECT_EQ(scene.tool[0].name, "ball");
  EXPECT_EQ(scene.tool[0].radius_m, 0.005);
  EXPECT_EQ(scene.tool[0].friction, 0.3);
  EXPECT_EQ(scene.tool[0].presliding_m, 0.0005);
  ASSERT_TRUE(scene.reach.box_m.has_value());
  EXPECT_EQ(scene.reach.box_m->min(), Eigen::Vector3d(-1.0, -1.0, -0.001));
  EXPECT_EQ(scene.reach.depth_max_m, 0.005);
  EXPECT_EQ(scene.reach.force_max_n, 8.0);
  EXPECT_EQ(scene.force_relative, 0.04);
  EXPECT_EQ(scene.contact_resolution, 3.0);
  EXPECT_EQ(scene.text, kScene);
}

TEST(Scene, LinearPressesDoNotStick) {
  std::string text = kScene;
  text.replace(text.find("presliding_m = 0.0005"), 0, "contact = \"sticking\"\n");
  EXPECT_NO_THROW((void)read_scene_text(text));
  text.replace(text.find("force_relative"), 0, "method = \"linear\"\n");
  try {
    (void)read_scene_text(text);
    FAIL() << "friction was promised and left out";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("linear presses are \"frictionless\""),
              std::string::npos)
        << error.what();
  }
}

TEST(Scene, OptionalKeysHaveDefaults) {
  std::string text = kScene;
  text.erase(text.find("[accuracy]"));
  text.erase(text.find("force_max_n"));
  text.erase(text.find("box_m = [[-1.0, -1.0, -0.001]"), 48);
  text.erase(text.find("friction"), 37);
  const Scene scene = read_scene_text(text);
  EXPECT_FALSE(scene.reach.box_m.has_value());
  EXPECT_TRUE(std::isinf(scene.reach.force_max_n));
  EXPECT_EQ(scene.force_relative, 0.05);
  EXPECT_EQ(scene.contact_resolution, 0.0);
  EXPECT_EQ(scene.accuracy.depths, 20);
  EXPECT_EQ(scene.accuracy.method, "auto");
  EXPECT_EQ(scene.accuracy.refine, "auto");
  EXPECT_EQ(scene.accuracy.solve, "auto");
  EXPECT_EQ(scene.accuracy.solve_depths, "auto");
  EXPECT_EQ(scene.accuracy.verify, 19);
  EXPECT_FALSE(scene.drawing.displacement);
  EXPECT_EQ(scene.drawing.error_relative, 0.02);
  EXPECT_TRUE(scene.inclusion.empty());
  EXPECT_TRUE(scene.support[0].is_fixed());
  EXPECT_FALSE(scene.tool[0].axis.has_value());
  EXPECT_FALSE(scene.tool[0].sticking);
  EXPECT_EQ(scene.tool[0].friction, 0.0);
}

TEST(Scene, ACutOutsCoarseEdgesAreHalfItsRadius) {
  EXPECT_FALSE(read_scene_text(kScene).cutout.has_value());
  const Scene scene =
      read_scene_text(std::string(kScene) + "[cutout]\nradius_m = 0.03\n");
  ASSERT_TRUE(scene.cutout.has_value());
  EXPECT_EQ(scene.cutout->radius_m, 0.03);
  EXPECT_EQ(scene.cutout->exterior, "coarse");
  EXPECT_EQ(scene.cutout->coarse_edge_m, 0.015);
}

TEST(Scene, CutOutsThatContradictTheSceneAreRefused) {
  const auto refusal = [](const std::string& more) {
    try {
      (void)read_scene_text(kScene + more);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refusal("refine = \"local\"\n[cutout]\nradius_m = 0.03\n")
                .find("accuracy.refine is \"local\", must be \"auto\" or \"global\""),
            std::string::npos);
  EXPECT_NE(
      refusal(
          "[cutout]\nradius_m = 0.03\nexterior = \"clamped\"\ncoarse_edge_m = 0.01\n")
          .find("coarse_edge_m belongs to exterior = \"coarse\""),
      std::string::npos);
}

class SceneMistake : public SceneMistakeTest {};

TEST_P(SceneMistake, IsNamedWithItsLine) {
  expect_named(GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Keys, SceneMistake,
    testing::Values(
        Mistake{"poissons_ratio", "poisson_ratio",
                ":9: unknown key \"poisson_ratio\" in [[material]]; the nearest known "
                "one is \"poissons_ratio\""},
        Mistake{"[reach]", "[raech]",
                ":22: unknown key \"raech\" in the scene; the nearest known one is "
                "\"reach\""},
        Mistake{"contact_resolution", "\"a\\nb\"", ":29: unknown key \"a\\nb\""},
        Mistake{"length_unit = \"cm\"", "", ":1: [body] needs the key \"length_unit\""},
        Mistake{"radius_m = 0.005", "", ":15: [[tool]] needs the key \"radius_m\""},
        Mistake{"[reach]\n", "[accuracy]\n", ":27: is not TOML"},
        Mistake{"[[tool]]", "[tool]",
                ":15: \"tool\" must be a list of tables: write [[tool]]"},
        Mistake{"[reach]", "[[reach]]", ":22: \"reach\" must be one table"}));

INSTANTIATE_TEST_SUITE_P(
    Values, SceneMistake,
    testing::Values(
        Mistake{"5000.0", "\"soft\"",
                ":8: youngs_modulus_pa in [[material]] is a text, must be a number"},
        Mistake{"5000.0", "0.0",
                ":8: youngs_modulus_pa in [[material]] is 0, must be positive"},
        Mistake{"5000.0", "-3",
                ":8: youngs_modulus_pa in [[material]] is -3, must be positive"},
        Mistake{"5000.0", "nan", ":8: youngs_modulus_pa in [[material]] is nan"},
        Mistake{"5000.0", "inf", ":8: youngs_modulus_pa in [[material]] is inf"},
        Mistake{"0.45", "0.5",
                ":9: poissons_ratio in [[material]] is 0.5, must be above -1 and below "
                "0.5"},
        Mistake{"0.45", "-1", ":9: poissons_ratio in [[material]] is -1"},
        Mistake{"\"linear\"", "\"gent\"",
                ":7: law \"gent\" in [[material]] is not available; available: "
                "linear, st-venant-kirchhoff, neo-hookean, mooney-rivlin, ogden, "
                "transversely-isotropic"},
        Mistake{"\"sphere\"", "\"spoon\"",
                ":17: shape \"spoon\" in [[tool]] is not available; available: "
                "sphere, spheres, flat-punch, cone, capsule, mesh"},
        Mistake{"\"fixed\"", "\"sliding\"",
                ":13: kind \"sliding\" in [[support]] is not available; available: "
                "fixed, foundation"},
        Mistake{"region = \"body\"", "region = \"nodule\"",
                ":6: region \"nodule\" in [[material]] is not available; available: "
                "body"},
        Mistake{"\"cm\"", "\"furlong\"", ":3: length_unit in [body]: unknown length"},
        Mistake{"\"cm\"", "\"\"", ":3: length_unit in [body] is empty"},
        Mistake{"\"liver.obj\"", "7", ":2: mesh in [body] is a number, must be a text"},
        Mistake{"radius_m = 0.005", "radius_m = 0", ":18: radius_m in [[tool]] is 0"},
        Mistake{"friction = 0.3", "friction = 11",
                ":19: friction in [[tool]] is 11, must be in [0, 10]"},
        Mistake{"presliding_m = 0.0005", "presliding_m = 0.0",
                ":15: tool \"ball\": friction 0.3 needs presliding_m > 0"},
        Mistake{"\"ball\"", "\"a/b\"", ":15: tool name \"a/b\" cannot be used"},
        Mistake{"depth_max_m = 0.005", "depth_max_m = -0.005",
                ":24: depth_max_m in [reach] is -0.005"},
        Mistake{"force_max_n = 8.0", "force_max_n = inf",
                ":25: force_max_n in [reach] is inf"},
        Mistake{"0.04", "1.0",
                ":28: force_relative in [accuracy] is 1, must be above 0 and below 1"},
        Mistake{"contact_resolution = 3", "contact_resolution = 0.25",
                ":29: contact_resolution in [accuracy] is 0.25, must be 0 or in "
                "[0.5, 16]"}));

INSTANTIATE_TEST_SUITE_P(
    Boxes, SceneMistake,
    testing::Values(
        Mistake{"[1.0, 1, -0.0199]", "[1.0, 1, -2.0]",
                ":12: box_m in [[support]] goes from -1 to -2 along z"},
        Mistake{"[1.0, 1, -0.0199]", "[1.0, 1]",
                ":12: a corner of box_m in [[support]] must have three coordinates"},
        Mistake{"[[-1.0, -1.0, -1.0], [1.0, 1, -0.0199]]", "7",
                ":12: box_m in [[support]] must be two corners"},
        Mistake{"[1.0, 1, -0.0199]", "[1.0, \"x\", 0.0]",
                ":12: a corner of box_m in [[support]] is a text, must be a number"},
        Mistake{"[1.0, 1, -0.0199]", "[1.0, inf, 0.0]",
                ":12: a coordinate of a corner of box_m in [[support]] is inf"}));

TEST(Scene, NeedsSupportToolAndMaterial) {
  for (const char* name : {"material", "support", "tool"}) {
    std::string text = kScene;
    const std::size_t begin = text.find(std::string("[[") + name);
    text.erase(begin, text.find("\n\n", begin) - begin);
    EXPECT_NE(
        error_of(text).find(std::string("scene.toml: the scene needs at least one "
                                        "[[") +
                            name + "]]"),
        std::string::npos)
        << error_of(text);
  }
}

TEST(Scene, NamesOfToolsAndRegionsAreUnique) {
  const std::string tool =
      "\n[[tool]]\nname = \"ball\"\nshape = \"sphere\"\nradius_m = 1\n";
  EXPECT_NE(error_of(kScene + tool).find(":32: the name \"ball\" belongs to two tools"),
            std::string::npos)
      << error_of(kScene + tool);
  const std::string material =
      "\n[[material]]\nregion = \"body\"\nlaw = \"linear\"\nyoungs_modulus_pa = "
      "1\npoissons_ratio = 0\n";
  EXPECT_NE(error_of(kScene + material).find(":31: region \"body\" has two materials"),
            std::string::npos)
      << error_of(kScene + material);
}

TEST(Scene, AMissingFileIsAnInputError) {
  const ScratchFolder folder;
  EXPECT_THROW((void)read_scene(folder / "no.toml"), InputError);
  EXPECT_THROW((void)read_scene(folder.path()), InputError);
}

TEST(Scene, EveryBeginningOfAFileIsReadOrRefused) {
  const std::string text = kScene;
  int refused = 0;
  for (std::size_t length = 0; length < text.size(); ++length) {
    refused += error_of(text.substr(0, length)) == "no error" ? 0 : 1;
  }
  // Only the optional end of the file can be missing.
  EXPECT_GT(refused, static_cast<int>(text.find("depth_max_m")));
}

}  // namespace
}  // namespace palpate
