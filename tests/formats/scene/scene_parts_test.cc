#include "formats/scene/scene_parts.h"

#include <cmath>

#include "formats/base/toml_text.h"
#include "tests/support/said.h"

namespace palpate::scene_parts {
namespace {

constexpr std::string_view kToolKeys[] = {"name",        "sphere",  "mesh",
                                          "length_unit", "plastic", "damage"};

// A scene of one part alone.
struct PartOfScene {
  explicit PartOfScene(const std::string& text) : root(parse_toml(text, "a.toml")) {}
  SceneFile file{"a.toml", "/bodies/liver"};
  toml::table root;
  Sections sections{file, root};
};

TEST(SceneParts, TablesThatAreNotKnownAreRefused) {
  EXPECT_NO_THROW(PartOfScene("[body]\n[[layer]]\n[cutout]\n"));
  expect_says(refusal([] {
                PartOfScene("[body]\n[bdy]\n");
              }),
              "a.toml:2: unknown key \"bdy\" in the scene; the nearest known one is "
              "\"body\"");
}

TEST(SceneParts, OneTableIsNoListAndAListNoTable) {
  const PartOfScene scene(
      "[body]\nname = \"it\"\n[[tool]]\nname = \"a\"\n"
      "[[tool]]\nname = \"b\"\n");
  EXPECT_TRUE(scene.sections.has("body"));
  EXPECT_FALSE(scene.sections.has("reach"));
  EXPECT_EQ(scene.sections.one("body", kToolKeys).title(), "[body]");
  const std::vector<SceneSection> tools = scene.sections.all("tool", kToolKeys);
  ASSERT_EQ(tools.size(), 2U);
  EXPECT_EQ(tools[0].title(), "[[tool]]");
  EXPECT_EQ(tools[0].text("name"), "a");
  EXPECT_EQ(tools[1].text("name"), "b");
  EXPECT_EQ(refusal([&] {
              (void)scene.sections.one("tool", kToolKeys);
            }),
            "a.toml:3: \"tool\" must be one table: write [tool]");
  EXPECT_EQ(refusal([&] {
              (void)scene.sections.all("body", kToolKeys);
            }),
            "a.toml:1: \"body\" must be a list of tables: write [[body]]");
  EXPECT_EQ(refusal([&] {
              (void)scene.sections.one("reach", kToolKeys);
            }),
            "a.toml:1: the scene needs the key \"reach\"");
  EXPECT_EQ(refusal([&] {
              (void)scene.sections.all("material", kToolKeys);
            }),
            "a.toml: the scene needs at least one [[material]]");
}

TEST(SceneParts, AListOfOtherThingsIsNoListOfTables) {
  for (const char* list : {"tool = []", "tool = [1]", "tool = [{ name = \"a\" }, 2]"}) {
    const PartOfScene scene(list);
    EXPECT_EQ(refusal([&] {
                (void)scene.sections.all("tool", kToolKeys);
              }),
              "a.toml:1: \"tool\" must be a list of tables: write [[tool]]")
        << list;
  }
}

TEST(SceneParts, EveryTableOfAListKnowsItsKeys) {
  const PartOfScene scene("[[tool]]\nname = \"a\"\n[[tool]]\nnmae = \"b\"\n");
  expect_says(refusal([&] {
                (void)scene.sections.all("tool", kToolKeys);
              }),
              "a.toml:4: unknown key \"nmae\" in [[tool]]; the nearest known one is "
              "\"name\"");
}

TEST(SceneParts, MeshesLieBesideTheSceneUnlessAbsolute) {
  const auto mesh = [](const std::string& keys) {
    const PartOfScene scene("[body]\n" + keys);
    return read_mesh_keys(scene.sections.one("body", kToolKeys), scene.file);
  };
  EXPECT_EQ(mesh("mesh = \"a/b.obj\"\nlength_unit = \"mm\"").file,
            "/bodies/liver/a/b.obj");
  EXPECT_EQ(mesh("mesh = \"/c.obj\"\nlength_unit = \"mm\"").file, "/c.obj");
  EXPECT_EQ(mesh("mesh = \"c.obj\"\nlength_unit = \"in\"").length_unit, "in");
  const std::string unknown = refusal([&] {
    (void)mesh("mesh = \"c.obj\"\nlength_unit = \"ft\"");
  });
  expect_says(unknown, "a.toml:3: length_unit in [body]: ");
  expect_says(unknown, "ft");
  expect_says(unknown, "mm");
  expect_says(refusal([&] {
                (void)mesh("mesh = \"c.obj\"");
              }),
              "[body] needs the key \"length_unit\"");
}

TEST(SceneParts, ABallHasACentreAndAPositiveRadius) {
  const auto ball = [](const std::string& value) {
    const PartOfScene scene("[body]\nsphere = " + value);
    return read_ball(scene.sections.one("body", kToolKeys), "sphere");
  };
  const SceneBall read = ball("{ center_m = [1, -2, 3], radius_m = 0.5 }");
  EXPECT_EQ(read.center_m, Eigen::Vector3d(1.0, -2.0, 3.0));
  EXPECT_EQ(read.radius_m, 0.5);
  EXPECT_EQ(refusal([&] {
              (void)ball("{ center_m = [0, 0, 0], radius_m = 0 }");
            }),
            "a.toml:2: radius_m in sphere of [body] is 0, must be positive and finite");
  expect_says(refusal([&] {
                (void)ball("{ radius_m = 1 }");
              }),
              "sphere of [body] needs the key \"center_m\"");
}

TEST(SceneParts, RulesEndWhereTheirTextsSay) {
  const double below_half = std::nextafter(0.5, 0.0);
  const double above_minus_one = std::nextafter(-1.0, 0.0);
  const double below_one = std::nextafter(1.0, 0.0);
  EXPECT_TRUE(kPoisson.holds(below_half) && kPoisson.holds(above_minus_one));
  EXPECT_FALSE(kPoisson.holds(0.5) || kPoisson.holds(-1.0));
  EXPECT_TRUE(kFraction.holds(1e-300) && kFraction.holds(below_one));
  EXPECT_FALSE(kFraction.holds(0.0) || kFraction.holds(1.0));
  EXPECT_TRUE(kBelowOne.holds(0.0) && kBelowOne.holds(below_one));
  EXPECT_FALSE(kBelowOne.holds(1.0) || kBelowOne.holds(-1e-300));
  for (const NumberRule& rule : {kPoisson, kFraction, kBelowOne}) {
    EXPECT_FALSE(rule.holds(std::nan(""))) << rule.text;
  }
}

TEST(SceneParts, YieldingTakesEachNumberFromItsOwnKey) {
  const auto yielding = [](const std::string& keys) {
    const PartOfScene scene("[body]\n" + keys);
    return read_yielding(scene.sections.one("body", kToolKeys));
  };
  const SceneYielding none = yielding("name = \"a\"");
  EXPECT_FALSE(none.plastic.has_value() || none.damage.has_value());
  const SceneYielding both = yielding(
      "plastic = { yield_depth_m = 0.001, share = 0.25 }\n"
      "damage = { onset_m = 0.002, scale_m = 0.003, largest = 0.5 }");
  ASSERT_TRUE(both.plastic.has_value() && both.damage.has_value());
  EXPECT_EQ(both.plastic->yield_depth_m, 0.001);
  EXPECT_EQ(both.plastic->share, 0.25);
  EXPECT_EQ(both.damage->onset_m, 0.002);
  EXPECT_EQ(both.damage->scale_m, 0.003);
  EXPECT_EQ(both.damage->largest, 0.5);
  expect_says(refusal([&] {
                (void)yielding("plastic = { yield_depth_m = 0, share = 1 }");
              }),
              "share in plastic of [body] is 1, must be in [0, 1)");
  expect_says(refusal([&] {
                (void)yielding("damage = { onset_m = 0, scale_m = 0, largest = 0 }");
              }),
              "scale_m in damage of [body] is 0, must be positive");
}

}  // namespace
}  // namespace palpate::scene_parts
