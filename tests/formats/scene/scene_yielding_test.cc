// Dents that stay and responses that soften, of scenes.
#include "formats/scene/scene.h"
#include "tests/formats/scene/scene_text.h"

namespace palpate {
namespace {

constexpr const char* kNeoHookean =
    "law = \"neo-hookean\"\nyoungs_modulus_pa = 5000.0\npoissons_ratio = 0.45\n";

TEST(SceneYieldingKeys, AnyMaterialMayYield) {
  EXPECT_FALSE(material_of(kIsotropic).yielding.plastic);
  for (const std::string& law : {std::string(kIsotropic), std::string(kNeoHookean)}) {
    const SceneYielding yielding =
        material_of(law +
                    "plastic = { yield_depth_m = 0.001, share = 0.4 }\n"
                    "damage = { onset_m = 0, scale_m = 0.003, largest = 0.5 }\n")
            .yielding;
    ASSERT_TRUE(yielding.plastic && yielding.damage);
    EXPECT_EQ(yielding.plastic->yield_depth_m, 0.001);
    EXPECT_EQ(yielding.plastic->share, 0.4);
    EXPECT_EQ(yielding.damage->onset_m, 0.0);
    EXPECT_EQ(yielding.damage->scale_m, 0.003);
    EXPECT_EQ(yielding.damage->largest, 0.5);
  }
}

TEST(SceneYieldingKeys, AToolMayLeaveDentsAndSoften) {
  const Scene scene = read_scene_text(
      scene_with(kSphere,
                 "shape = \"sphere\"\nradius_m = 0.005\n"
                 "plastic = { yield_depth_m = 0.001, share = 0.4 }\n"
                 "damage = { onset_m = 0.001, scale_m = 0.003, largest = 0.5 }\n"));
  ASSERT_EQ(scene.tool_yielding.size(), 1U);
  EXPECT_EQ(scene.tool_yielding[0].plastic->share, 0.4);
  EXPECT_EQ(scene.tool_yielding[0].damage->largest, 0.5);
  EXPECT_FALSE(read_scene_text(kScene).tool_yielding.at(0).plastic);
}

class SceneYieldingMistake : public SceneMistakeTest {};

TEST_P(SceneYieldingMistake, IsNamedWithItsLine) {
  expect_named(GetParam());
}

// The scene's material with another key, on line 10.
#define PALPATE_YIELDING(key)                 \
  "law = \"linear\"\nyoungs_modulus_pa = 1\n" \
  "poissons_ratio = 0\n" key "\n"

INSTANTIATE_TEST_SUITE_P(
    Yielding, SceneYieldingMistake,
    testing::Values(
        Mistake{kIsotropic,
                PALPATE_YIELDING("plastic = { yield_depth_m = 0.001, share = 1 }"),
                ":10: share in plastic of [[material]] is 1, must be in [0, 1)"},
        Mistake{kIsotropic,
                PALPATE_YIELDING("plastic = { yield_depth_m = 0.001, share = -0.1 }"),
                ":10: share in plastic of [[material]] is -0.1, must be in [0, 1)"},
        Mistake{kIsotropic,
                PALPATE_YIELDING("plastic = { yield_depth_m = -0.001, share = 0.4 }"),
                ":10: yield_depth_m in plastic of [[material]] is -0.001, must be zero "
                "or more"},
        Mistake{kIsotropic, PALPATE_YIELDING("plastic = { share = 0.4 }"),
                ":10: plastic of [[material]] needs the key \"yield_depth_m\""},
        Mistake{
            kIsotropic,
            PALPATE_YIELDING("damage = { onset_m = 0, scale_m = 0, largest = 0.5 }"),
            ":10: scale_m in damage of [[material]] is 0, must be positive"},
        Mistake{
            kIsotropic,
            PALPATE_YIELDING("damage = { onset_m = 0, scale_m = 0.1, largest = 2 }"),
            ":10: largest in damage of [[material]] is 2, must be in [0, 1)"}));

}  // namespace
}  // namespace palpate
