#include "precompute/material/material_spectrum.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace palpate {
namespace {

Scene scene_of(const std::vector<SceneRelaxation>& relaxations) {
  Scene scene;
  for (const SceneRelaxation& relaxation : relaxations) {
    SceneMaterial material;
    material.youngs_modulus_pa = 100.0;
    material.poissons_ratio = 0.4;
    material.mu_pa = {1.0, 2.0};
    material.k1_pa = 3.0;
    material.k2 = 0.5;
    material.relaxation = relaxation;
    scene.material.push_back(material);
  }
  return scene;
}

const SceneRelaxation kShort{{0.2, 0.3}, {0.1, 1.0}};

TEST(MaterialSpectrum, IsUniformWhereAllMaterialsAgree) {
  const SceneSpectrum spectrum = spectrum_of(scene_of({kShort, kShort}));
  EXPECT_EQ(spectrum.tau_s, kShort.tau_s);
  EXPECT_EQ(spectrum.g, kShort.g);
  EXPECT_TRUE(spectrum_of(scene_of({{}, {}})).empty());
}

TEST(MaterialSpectrum, HasFourTimesInEqualRatiosWhereMaterialsDiffer) {
  const SceneSpectrum spectrum =
      spectrum_of(scene_of({{{0.2}, {0.1}}, {{0.75}, {25.0}}}));
  EXPECT_FALSE(spectrum.uniform());
  ASSERT_EQ(spectrum.tau_s.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(spectrum.tau_s[i], std::pow(10.0, static_cast<double>(i) - 1.0), 1e-9);
  }
  // A material that does not relax makes the body's responses differ as well.
  EXPECT_FALSE(spectrum_of(scene_of({kShort, {}})).uniform());
  EXPECT_EQ(spectrum_of(scene_of({kShort, {}})).tau_s.size(), 4U);
}

// Springs do not relax: at the nodes that they bear a body gives less and less way.
TEST(MaterialSpectrum, DiffersFromNodeToNodeOnAFoundation) {
  Scene scene = scene_of({kShort, kShort});
  scene.support.emplace_back();
  EXPECT_TRUE(spectrum_of(scene).uniform());
  scene.support.emplace_back().stiffness_pa_per_m = 20e3;
  EXPECT_FALSE(spectrum_of(scene).uniform());
  EXPECT_EQ(spectrum_of(scene).tau_s.size(), 4U);
  scene.material[0].relaxation = scene.material[1].relaxation = {};
  EXPECT_TRUE(spectrum_of(scene).empty());
}

TEST(MaterialSpectrum, RelaxesEveryModulusAndNothingElse) {
  const Scene scene = scene_of({kShort, {}});
  const Scene relaxed = transformed_scene(scene, 3.0);
  const double share = 1.0 - 0.2 / 1.3 - 0.3 / 4.0;
  const SceneMaterial& material = relaxed.material[0];
  EXPECT_NEAR(material.youngs_modulus_pa, 100.0 * share, 1e-12);
  EXPECT_NEAR(material.mu_pa[1], 2.0 * share, 1e-14);
  EXPECT_NEAR(material.k1_pa, 3.0 * share, 1e-14);
  EXPECT_EQ(material.k2, 0.5);
  EXPECT_EQ(material.poissons_ratio, 0.4);
  EXPECT_EQ(relaxed.material[1].youngs_modulus_pa, 100.0);
  constexpr double kSudden = std::numeric_limits<double>::infinity();
  EXPECT_EQ(transformed_scene(scene, kSudden).material[0].youngs_modulus_pa, 100.0);
  EXPECT_NEAR(transformed_scene(scene, 0.0).material[0].youngs_modulus_pa, 50.0, 1e-12);
}

}  // namespace
}  // namespace palpate
