// Sweeps over materials: names of constants, grids, and what linear elasticity
// promises.
#include "precompute/build/material_sweep.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/mesh/obj_writer.h"
#include "precompute/surface/primitive_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

class MaterialSweep : public testing::Test {
 protected:
  MaterialSweep() {
    write_obj(icosphere_body(), folder_ / "ball.obj", "a test");
    std::ofstream(folder_ / "scene.toml")
        << "[body]\nmesh = \"ball.obj\"\nlength_unit = \"m\"\n"
           "[[material]]\nregion = \"body\"\nlaw = \"linear\"\n"
           "youngs_modulus_pa = 5000.0\npoissons_ratio = 0.4\n"
           "[[support]]\nbox_m = [[-1, -1, -1], [1, 1, -0.03]]\nkind = \"fixed\"\n"
           "[[tool]]\nname = \"ball\"\nshape = \"sphere\"\nradius_m = 0.01\n"
           "[reach]\ndepth_max_m = 0.003\n[accuracy]\nforce_relative = 0.2\n";
    scene_ = read_scene(folder_ / "scene.toml");
  }

  static SurfaceMesh icosphere_body() {
    return sphere_surface(Eigen::Vector3d::Zero(), 0.05, 0.015);
  }

  ScratchFolder folder_;
  Scene scene_;
};

TEST_F(MaterialSweep, GridHasEqualRatiosAndBothEnds) {
  const SweepParameter grid = grid_of("youngs_modulus_pa", 1000.0, 8000.0, 4);
  ASSERT_EQ(grid.value.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(grid.value[i], 1000.0 * std::pow(2.0, static_cast<double>(i)), 1e-9);
  }
  EXPECT_EQ(grid.value.back(), 8000.0);
  EXPECT_THROW((void)grid_of("x", 0.0, 1.0, 3), InputError);
  EXPECT_THROW((void)grid_of("x", 2.0, 1.0, 3), InputError);
  EXPECT_THROW((void)grid_of("x", 1.0, 2.0, 1), InputError);
}

TEST_F(MaterialSweep, SetsConstantsByNameAndRefusesOthers) {
  set_constant(scene_, "youngs_modulus_pa", 123.0);
  EXPECT_EQ(scene_.material[0].youngs_modulus_pa, 123.0);
  set_constant(scene_, "body.poissons_ratio", 0.3);
  EXPECT_EQ(scene_.material[0].poissons_ratio, 0.3);
  EXPECT_THROW(set_constant(scene_, "c10_pa", 1.0), InputError);  // another law's
  EXPECT_THROW(set_constant(scene_, "nodule.youngs_modulus_pa", 1.0), InputError);
}

TEST_F(MaterialSweep, ForceOfALinearBodyGoesWithItsModulus) {
  const BodySource body = read_body(scene_);
  Eigen::Index top = 0;
  body.surface.position_m.col(2).maxCoeff(&top);
  const std::int32_t vertices[] = {static_cast<std::int32_t>(top)};
  Progress silent(nullptr);
  const ResponseSweep sweep =
      sweep_materials(scene_, body, body.tool.front(), vertices,
                      {grid_of("youngs_modulus_pa", 2000.0, 8000.0, 3)}, silent);
  ASSERT_EQ(sweep.combinations(), 3U);
  EXPECT_NEAR(sweep.depth_m.back(), 0.003, 5e-5);  // past first touch
  for (std::size_t c = 1; c < 3; ++c) {
    for (std::size_t k = 0; k < sweep.depth_m.size(); ++k) {
      const double ratio = sweep.curve_n(0, c)[k] / sweep.curve_n(0, 0)[k];
      EXPECT_NEAR(ratio, std::pow(2.0, static_cast<double>(c)), 1e-6 * ratio);
    }
  }
  EXPECT_GT(sweep.error_relative, 0.0);
  EXPECT_LT(sweep.error_relative, 0.1);
  // Values that no material has are found before anything is pressed.
  EXPECT_THROW((void)sweep_materials(scene_, body, body.tool.front(), vertices,
                                     {grid_of("poissons_ratio", 0.3, 0.6, 2)}, silent),
               InputError);
}

}  // namespace
}  // namespace palpate
