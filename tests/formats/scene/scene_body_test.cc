// Materials, inclusions and supports of scenes.
#include "formats/scene/scene.h"
#include "tests/formats/scene/scene_text.h"

namespace palpate {
namespace {

constexpr const char* kPlace = "box_m = [[-1.0, -1.0, -1.0], [1.0, 1, -0.0199]]\n";

constexpr const char* kLinearFibre =
    "law = \"transversely-isotropic\"\nfibre_law = \"linear\"\nfibre = [0, 3, 4]\n"
    "youngs_modulus_fibre_pa = 20\nyoungs_modulus_pa = 10\n"
    "shear_modulus_fibre_pa = 4\npoissons_ratio_fibre = 0.3\npoissons_ratio = 0.4\n";

SceneSupport support_at(const std::string& place) {
  return read_scene_text(scene_with(kPlace, place)).support.at(0);
}

// A scene with one inclusion, whose other keys are given, of a material of its own.
std::string with_nodule(const std::string& keys) {
  return kScene + ("\n[[inclusion]]\nname = \"nodule\"\n" + keys) +
         "\n[[material]]\nregion = \"nodule\"\nlaw = \"linear\"\n"
         "youngs_modulus_pa = 1\npoissons_ratio = 0\n";
}

constexpr const char* kBall = "sphere = { center_m = [0, 0, 0.01], radius_m = 0.002 }";

TEST(SceneLayers, FollowEachOtherInwardsAndHaveMaterials) {
  const std::string material =
      "[[material]]\nlaw = \"linear\"\nyoungs_modulus_pa = 1\npoissons_ratio = 0\n";
  const std::string layers =
      kScene + ("\n[[layer]]\nname = \"skin\"\nthickness_m = 0.002\n[[layer]]\n"
                "name = \"fat\"\nthickness_m = 0.003\n" +
                material + "region = \"skin\"\n" + material);
  const Scene scene = read_scene_text(layers + "region = \"fat\"\n");
  ASSERT_EQ(scene.inclusion.size(), 2U);
  EXPECT_EQ(scene.inclusion[0].under_m, 0.002);
  EXPECT_EQ(scene.inclusion[1].under_m, 0.002 + 0.003);
  EXPECT_THROW((void)read_scene_text(layers + "region = \"skin\"\n"), InputError);
}

TEST(SceneMaterial, IsotropicLawsHaveModulusAndRatio) {
  for (const std::string law : {"linear", "st-venant-kirchhoff", "neo-hookean"}) {
    const SceneMaterial material = material_of(
        "law = \"" + law + "\"\nyoungs_modulus_pa = 1\npoissons_ratio = -0.9\n");
    EXPECT_EQ(material.law, law);
    EXPECT_EQ(material.youngs_modulus_pa, 1.0);
    EXPECT_EQ(material.poissons_ratio, -0.9);
  }
}

TEST(SceneMaterial, MooneyRivlinHasTwoModuli) {
  const SceneMaterial material = material_of(
      "law = \"mooney-rivlin\"\nc10_pa = 7\nc01_pa = 0\npoissons_ratio = 0.49\n");
  EXPECT_EQ(material.c10_pa, 7.0);
  EXPECT_EQ(material.c01_pa, 0.0);
  EXPECT_EQ(material.poissons_ratio, 0.49);
}

TEST(SceneMaterial, OgdenHasTerms) {
  const SceneMaterial material = material_of(
      "law = \"ogden\"\nmu_pa = [5, -2.5]\nalpha = [2, -3.5]\npoissons_ratio = 0\n");
  EXPECT_EQ(material.mu_pa, (std::vector<double>{5.0, -2.5}));
  EXPECT_EQ(material.alpha, (std::vector<double>{2.0, -3.5}));
}

TEST(SceneMaterial, LinearFibreHasFiveModuliAndAUnitDirection) {
  const SceneMaterial material = material_of(kLinearFibre);
  EXPECT_EQ(material.fibre_law, "linear");
  EXPECT_TRUE(material.fibre.isApprox(Eigen::Vector3d(0.0, 0.6, 0.8), 1e-15));
  EXPECT_EQ(material.youngs_modulus_fibre_pa, 20.0);
  EXPECT_EQ(material.youngs_modulus_pa, 10.0);
  EXPECT_EQ(material.shear_modulus_fibre_pa, 4.0);
  EXPECT_EQ(material.poissons_ratio_fibre, 0.3);
  EXPECT_EQ(material.poissons_ratio, 0.4);
  EXPECT_FALSE(material.finite_strain);
  EXPECT_TRUE(
      material_of(std::string(kLinearFibre) + "finite_strain = true\n").finite_strain);
}

TEST(SceneMaterial, ExponentialFibreHasAMatrix) {
  const SceneMaterial material = material_of(
      "law = \"transversely-isotropic\"\nfibre_law = \"exponential\"\n"
      "fibre = [1, 0, 0]\nyoungs_modulus_pa = 3\npoissons_ratio = 0.4\nk1_pa = 5\n"
      "k2 = 0.5\n");
  EXPECT_EQ(material.youngs_modulus_pa, 3.0);
  EXPECT_EQ(material.poissons_ratio, 0.4);
  EXPECT_EQ(material.k1_pa, 5.0);
  EXPECT_EQ(material.k2, 0.5);
}

TEST(SceneInclusion, IsABallOrAMeshWithItsMaterial) {
  const Scene ball = read_scene_text(with_nodule(kBall));
  ASSERT_EQ(ball.inclusion.size(), 1u);
  EXPECT_EQ(ball.inclusion[0].name, "nodule");
  EXPECT_FALSE(ball.inclusion[0].cavity);
  EXPECT_FALSE(ball.inclusion[0].mesh.has_value());
  ASSERT_TRUE(ball.inclusion[0].sphere.has_value());
  EXPECT_EQ(ball.inclusion[0].sphere->center_m, Eigen::Vector3d(0.0, 0.0, 0.01));
  EXPECT_EQ(ball.inclusion[0].sphere->radius_m, 0.002);
  EXPECT_EQ(ball.material.at(1).region, "nodule");

  const Scene mesh =
      read_scene_text(with_nodule("mesh = \"nodule.obj\"\nlength_unit = \"mm\""));
  EXPECT_FALSE(mesh.inclusion[0].sphere.has_value());
  ASSERT_TRUE(mesh.inclusion[0].mesh.has_value());
  EXPECT_EQ(mesh.inclusion[0].mesh->file.filename(), "nodule.obj");
  EXPECT_EQ(mesh.inclusion[0].mesh->file.parent_path(), mesh.mesh.parent_path());
  EXPECT_EQ(mesh.inclusion[0].mesh->length_unit, "mm");
}

TEST(SceneInclusion, ACavityHasNoMaterial) {
  const std::string keys = std::string(kBall) + "\ncavity = true";
  const Scene scene =
      read_scene_text(kScene + ("\n[[inclusion]]\nname = \"cyst\"\n" + keys + "\n"));
  EXPECT_TRUE(scene.inclusion.at(0).cavity);
  EXPECT_EQ(scene.material.size(), 1u);
  EXPECT_NE(error_of(with_nodule(keys))
                .find("region \"nodule\" in [[material]] is not available; available: "
                      "body"),
            std::string::npos)
      << error_of(with_nodule(keys));
}

TEST(SceneInclusion, NeedsOneMaterial) {
  const std::string text =
      kScene + std::string("\n[[inclusion]]\nname = \"nodule\"\n") + kBall + "\n";
  EXPECT_NE(error_of(text).find("region \"nodule\" has no [[material]]"),
            std::string::npos)
      << error_of(text);
}

TEST(SceneSupport, IsFixedOrAFoundation) {
  EXPECT_TRUE(support_at(kPlace).is_fixed());
  const Scene scene = read_scene_text(scene_with(
      "kind = \"fixed\"", "kind = \"foundation\"\nstiffness_pa_per_m = 2e6"));
  EXPECT_FALSE(scene.support[0].is_fixed());
  EXPECT_EQ(scene.support[0].stiffness_pa_per_m, 2e6);
}

TEST(SceneSupport, ABoxHoldsWhatIsInside) {
  const SceneSupport box = support_at("box_m = [[0, 0, 0], [1, 2, 3]]\n");
  EXPECT_TRUE(holds(box, {1.0, 2.0, 3.0}));
  EXPECT_TRUE(holds(box, {0.5, 1.9, 2.9}));
  EXPECT_FALSE(holds(box, {1.1, 1.0, 1.0}));
}

TEST(SceneSupport, APlaneHoldsWhatItsNormalPointsAwayFrom) {
  const SceneSupport all =
      support_at("plane = { point_m = [0, 0, 1], normal = [0, 0, 2] }\n");
  EXPECT_TRUE(holds(all, {50.0, 3.0, 1.0}));
  EXPECT_TRUE(holds(all, {0.0, 0.0, -1e9}));
  EXPECT_FALSE(holds(all, {0.0, 0.0, 1.001}));
  // A slanted face of coordinates that are not exact.
  const Eigen::Vector3d normal = Eigen::Vector3d(1.0, 2.0, 3.0).normalized();
  SceneSupport slanted;
  slanted.plane = ScenePlane{{0.1, 0.2, 0.3}, normal};
  const Eigen::Vector3d along = normal.unitOrthogonal();
  for (const double distance_m : {-0.7, 1e-3, 0.3, 11.0}) {
    EXPECT_TRUE(holds(slanted, slanted.plane->point_m + distance_m * along));
  }
}

TEST(SceneSupport, APlaneMayHoldALayerOnly) {
  const SceneSupport layer = support_at(
      "plane = { point_m = [0, 0, 1], normal = [0, 0, 2], within_m = 0.25 }\n");
  EXPECT_TRUE(holds(layer, {0.0, 0.0, 0.75}));
  EXPECT_FALSE(holds(layer, {0.0, 0.0, 0.74}));
}

TEST(SceneSupport, APatchHoldsABall) {
  const SceneSupport patch =
      support_at("patch = { center_m = [1, 0, 0], radius_m = 0.5 }\n");
  EXPECT_TRUE(holds(patch, {1.5, 0.0, 0.0}));
  EXPECT_FALSE(holds(patch, {1.4, 0.4, 0.0}));
}

TEST(SceneMaterial, AnyLawMayRelax) {
  EXPECT_TRUE(material_of(kIsotropic).relaxation.g.empty());
  for (const std::string& law : {std::string(kIsotropic), std::string(kLinearFibre)}) {
    const SceneMaterial material =
        material_of(law + "relaxation = { g = [0.2, 0.3], tau_s = [0.5, 4] }\n");
    EXPECT_EQ(material.relaxation.g, (std::vector<double>{0.2, 0.3}));
    EXPECT_EQ(material.relaxation.tau_s, (std::vector<double>{0.5, 4.0}));
  }
}

class SceneBodyMistake : public SceneMistakeTest {};

TEST_P(SceneBodyMistake, IsNamedWithItsLine) {
  expect_named(GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Materials, SceneBodyMistake,
    testing::Values(
        Mistake{"poissons_ratio = 0.45", "poissons_ratio = 0.45\nc10_pa = 3",
                ":10: \"c10_pa\" in [[material]] does not belong to law \"linear\", "
                "which has: youngs_modulus_pa, poissons_ratio"},
        Mistake{"\"linear\"", "\"ogden\"",
                ":8: \"youngs_modulus_pa\" in [[material]] does not belong to law "
                "\"ogden\", which has: mu_pa, alpha, poissons_ratio"},
        Mistake{"\"linear\"", "\"transversely-isotropic\"",
                ":5: [[material]] needs the key \"fibre_law\""},
        Mistake{kIsotropic,
                "law = \"mooney-rivlin\"\nc10_pa = 0\nc01_pa = 0\npoissons_ratio = 0\n",
                ":8: c10_pa and c01_pa in [[material]] are both 0"},
        Mistake{kIsotropic,
                "law = \"mooney-rivlin\"\nc10_pa = -1\nc01_pa = 2\npoissons_ratio = "
                "0\n",
                ":8: c10_pa in [[material]] is -1, must be zero or more"},
        Mistake{kIsotropic, "law = \"mooney-rivlin\"\nc10_pa = 1\nc01_pa = 2\n",
                ":5: [[material]] needs the key \"poissons_ratio\""},
        Mistake{kIsotropic,
                "law = \"ogden\"\nmu_pa = [1, 2]\nalpha = [1]\npoissons_ratio = 0\n",
                ":9: alpha in [[material]] has 1 numbers, must have as many as mu_pa: "
                "2"},
        Mistake{kIsotropic,
                "law = \"ogden\"\nmu_pa = [1]\nalpha = [-1]\npoissons_ratio = 0\n",
                ":8: mu_pa 1 and alpha -1 in [[material]] are of different signs"},
        Mistake{kIsotropic,
                "law = \"ogden\"\nmu_pa = [1,1,1,1,1]\nalpha = [1,1,1,1,1]\n"
                "poissons_ratio = 0\n",
                ":8: mu_pa in [[material]] must be a list of 1 to 4 numbers"},
        Mistake{kIsotropic,
                "law = \"ogden\"\nmu_pa = [0]\nalpha = [1]\npoissons_ratio = 0\n",
                ":8: mu_pa in [[material]] holds 0, must be finite and not zero"},
        Mistake{kIsotropic,
                "law = \"ogden\"\nmu_pa = [1]\nalpha = 1\npoissons_ratio = 0\n",
                ":9: alpha in [[material]] must be a list of 1 to 4 numbers"}));

// The scene's material with these terms, on line 10.
#define PALPATE_RELAXING(terms)               \
  "law = \"linear\"\nyoungs_modulus_pa = 1\n" \
  "poissons_ratio = 0\nrelaxation = " terms "\n"

INSTANTIATE_TEST_SUITE_P(
    Relaxation, SceneBodyMistake,
    testing::Values(
        Mistake{kIsotropic, PALPATE_RELAXING("{ g = [0.5, 0.5], tau_s = [1, 2] }"),
                ":10: g in relaxation of [[material]] sums to 1, must stay below 1"},
        Mistake{kIsotropic, PALPATE_RELAXING("{ g = [0.7, 0.5], tau_s = [1, 2] }"),
                ":10: g in relaxation of [[material]] sums to 1.2, must stay below 1"},
        Mistake{kIsotropic, PALPATE_RELAXING("{ g = [1.5], tau_s = [1] }"),
                ":10: g in relaxation of [[material]] holds 1.5, must be above 0 and "
                "below 1"},
        Mistake{kIsotropic, PALPATE_RELAXING("{ g = [0.2, 0.5], tau_s = [2, 1] }"),
                ":10: tau_s in relaxation of [[material]] has 1 after 2, must "
                "increase"},
        Mistake{kIsotropic, PALPATE_RELAXING("{ g = [0.2, 0.5], tau_s = [2, 2] }"),
                ":10: tau_s in relaxation of [[material]] has 2 after 2"},
        Mistake{kIsotropic, PALPATE_RELAXING("{ g = [0.2], tau_s = [0] }"),
                ":10: tau_s in relaxation of [[material]] holds 0, must be positive"},
        Mistake{kIsotropic, PALPATE_RELAXING("{ g = [0.2], tau_s = [1, 2] }"),
                ":10: tau_s in relaxation of [[material]] has 2 numbers, must have as "
                "many as g: 1"},
        Mistake{kIsotropic, PALPATE_RELAXING("{ g = [0.2] }"),
                ":10: relaxation of [[material]] needs the key \"tau_s\""},
        Mistake{kIsotropic, PALPATE_RELAXING("{ g = [0.2], tau = [1] }"),
                ":10: unknown key \"tau\" in relaxation of [[material]]"},
        Mistake{kIsotropic,
                PALPATE_RELAXING("{ g = [0.1, 0.1, 0.1, 0.1, 0.1], tau_s = [1, 2, 3, "
                                 "4, 5] }"),
                ":10: g in relaxation of [[material]] must be a list of 1 to 4 "
                "numbers"}));

constexpr const char* kFibre =
    "law = \"transversely-isotropic\"\nfibre_law = \"linear\"\nfibre = [0, 0, 0]\n"
    "youngs_modulus_fibre_pa = 20\nyoungs_modulus_pa = 10\n"
    "shear_modulus_fibre_pa = 4\npoissons_ratio_fibre = 0.3\npoissons_ratio = 0.4\n";
constexpr const char* kFibreUnstable =
    "law = \"transversely-isotropic\"\nfibre_law = \"linear\"\nfibre = [0, 0, 1]\n"
    "youngs_modulus_fibre_pa = 10\nyoungs_modulus_pa = 10\n"
    "shear_modulus_fibre_pa = 4\npoissons_ratio_fibre = 0.5\npoissons_ratio = 0.5\n";
constexpr const char* kFibreMixed =
    "law = \"transversely-isotropic\"\nfibre_law = \"exponential\"\nfibre = [0, 0, 1]\n"
    "youngs_modulus_pa = 10\npoissons_ratio = 0.4\nk1_pa = 1\nk2 = 1\n"
    "finite_strain = true\n";
constexpr const char* kFibreWord =
    "law = \"transversely-isotropic\"\nfibre_law = \"cubic\"\n";
constexpr const char* kFibreLine =
    "law = \"transversely-isotropic\"\nfibre_law = \"exponential\"\nfibre = [0, 1]\n";

INSTANTIATE_TEST_SUITE_P(
    Fibres, SceneBodyMistake,
    testing::Values(
        Mistake{kIsotropic, kFibre,
                ":9: fibre in [[material]] is [0, 0, 0], must have a direction"},
        Mistake{kIsotropic, kFibreUnstable,
                ":13: poissons_ratio_fibre 0.5 and poissons_ratio 0.5 in [[material]] "
                "give 1 - nu_tt - 2 nu_lt^2 E_t / E_l = 0, must be positive"},
        Mistake{kIsotropic, kFibreMixed,
                ":14: \"finite_strain\" in [[material]] does not belong to law "
                "\"transversely-isotropic\" with fibre_law \"exponential\", which has: "
                "fibre, fibre_law, youngs_modulus_pa, poissons_ratio, k1_pa, k2"},
        Mistake{kIsotropic, kFibreWord,
                ":8: fibre_law \"cubic\" in [[material]] is not available; available: "
                "linear, exponential"},
        Mistake{kIsotropic, kFibreLine,
                ":9: fibre in [[material]] must have three coordinates"}));

INSTANTIATE_TEST_SUITE_P(
    Supports, SceneBodyMistake,
    testing::Values(
        Mistake{kPlace, "",
                ":11: [[support]] needs one of the keys: box_m, plane, patch"},
        Mistake{"kind = \"fixed\"", "patch = { center_m = [0, 0, 0], radius_m = 1 }",
                ":13: [[support]] has both box_m and patch, must have one of"},
        Mistake{"kind = \"fixed\"", "kind = \"foundation\"",
                ":11: [[support]] needs the key \"stiffness_pa_per_m\""},
        Mistake{"kind = \"fixed\"", "kind = \"foundation\"\nstiffness_pa_per_m = 0",
                ":14: stiffness_pa_per_m in [[support]] is 0, must be positive"},
        Mistake{"kind = \"fixed\"", "stiffness_pa_per_m = 1",
                ":13: stiffness_pa_per_m in [[support]] belongs to kind "
                "\"foundation\""},
        Mistake{"kind = \"fixed\"", "stifness_pa_per_m = 1",
                ":13: unknown key \"stifness_pa_per_m\" in [[support]]; the nearest "
                "known one is \"stiffness_pa_per_m\""},
        Mistake{kPlace, "plane = { point_m = [0, 0, 0], normal = [0, 0, 0] }\n",
                ":12: normal in plane of [[support]] is [0, 0, 0]"},
        Mistake{kPlace,
                "plane = { point_m = [0, 0, 0], normal = [0, 0, 1], within_m = 0 }\n",
                ":12: within_m in plane of [[support]] is 0, must be positive"},
        Mistake{kPlace, "plane = { point_m = [0, 0, 0], norml = [0, 0, 1] }\n",
                ":12: unknown key \"norml\" in plane of [[support]]"},
        Mistake{kPlace, "plane = [0, 0, 1]\n",
                ":12: plane in [[support]] is an array, must be a table: { point_m, "
                "normal, within_m }"},
        Mistake{kPlace, "patch = { center_m = [0, 0, 0], radius_m = -1 }\n",
                ":12: radius_m in patch of [[support]] is -1, must be positive"},
        Mistake{kPlace, "patch = { radius_m = 1 }\n",
                ":12: patch of [[support]] needs the key \"center_m\""}));

// Before line 22 of the scene.
constexpr const char* kReach = "[reach]";

INSTANTIATE_TEST_SUITE_P(
    Inclusions, SceneBodyMistake,
    testing::Values(
        Mistake{kReach,
                "[[inclusion]]\nname = \"body\"\n"
                "sphere = { center_m = [0, 0, 0], radius_m = 1 }\n[reach]",
                ":23: an inclusion cannot be named \"body\""},
        Mistake{kReach, "[[inclusion]]\nname = \"a\"\ncavity = true\n[reach]",
                ":22: [[inclusion]] needs one of the keys: sphere, mesh"},
        Mistake{kReach,
                "[[inclusion]]\nname = \"a\"\nmesh = \"a.obj\"\n"
                "sphere = { center_m = [0, 0, 0], radius_m = 1 }\n[reach]",
                ":24: [[inclusion]] has both sphere and mesh"},
        Mistake{kReach, "[[inclusion]]\nname = \"a\"\nmesh = \"a.obj\"\n[reach]",
                ":22: [[inclusion]] needs the key \"length_unit\""},
        Mistake{kReach,
                "[[inclusion]]\nname = \"a\"\nmesh = \"a.obj\"\nlength_unit = \"ft\"\n"
                "[reach]",
                ":25: length_unit in [[inclusion]]: unknown length"},
        Mistake{kReach,
                "[[inclusion]]\nname = \"a\"\nlength_unit = \"m\"\n"
                "sphere = { center_m = [0, 0, 0], radius_m = 1 }\n[reach]",
                ":24: length_unit in [[inclusion]] belongs to a mesh"},
        Mistake{kReach,
                "[[inclusion]]\nname = \"a\"\n"
                "sphere = { center_m = [0, 0, 0], radius_m = 0 }\n[reach]",
                ":24: radius_m in sphere of [[inclusion]] is 0, must be positive"},
        Mistake{kReach,
                "[[inclusion]]\nname = \"a\"\ncavity = 1\n"
                "sphere = { center_m = [0, 0, 0], radius_m = 1 }\n[reach]",
                ":24: cavity in [[inclusion]] is a number, must be true or false"},
        Mistake{kReach, "[[inclusion]]\nnmae = \"a\"\n[reach]",
                ":23: unknown key \"nmae\" in [[inclusion]]; the nearest known one is "
                "\"name\""},
        Mistake{kReach,
                "[[inclusion]]\nname = \"a\"\ncavity = true\n"
                "sphere = { center_m = [0, 0, 0], radius_m = 1 }\n"
                "[[inclusion]]\nname = \"a\"\ncavity = true\n"
                "sphere = { center_m = [0, 0, 0], radius_m = 1 }\n[reach]",
                ":27: the name \"a\" belongs to two inclusions"}));

}  // namespace
}  // namespace palpate
