#include "precompute/body/body_surface.h"

#include <fstream>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/mesh/obj_writer.h"
#include "precompute/body/scene_body.h"
#include "precompute/surface/primitive_bodies.h"
#include "tests/support/study_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

// The block of 100 x 100 x 20 mm that CAD exports.
constexpr const char* kBlock =
    "v 0 0 0\nv .1 0 0\nv 0 .1 0\nv .1 .1 0\nv 0 0 .02\nv .1 0 .02\nv 0 .1 .02\n"
    "v .1 .1 .02\nf 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 7 8\n"
    "f 3 8 4\nf 1 5 7\nf 1 7 3\nf 2 4 8\nf 2 8 6\n";

class BodySurface : public testing::Test {
 protected:
  Scene scene_of(const std::string& reach) const {
    std::ofstream(folder_ / "scene.toml") << R"([body]
mesh = "body.obj"
length_unit = "m"
[[material]]
region = "body"
law = "linear"
youngs_modulus_pa = 6000.0
poissons_ratio = 0.4
[[support]]
box_m = [[-1.0, -1.0, -1.0], [1.0, 1.0, 0.0001]]
[[tool]]
name = "tip"
shape = "sphere"
radius_m = 0.008
[reach]
depth_max_m = 0.005
)" << reach;
    return read_scene(folder_ / "scene.toml");
  }
  void write(const std::string& text) const {
    std::ofstream(folder_ / "body.obj") << text;
  }
  ScratchFolder folder_;
};

TEST_F(BodySurface, ABlockOfTwelveTrianglesIsRefinedWhereItIsPressed) {
  write(kBlock);
  const Scene scene = scene_of("box_m = [[0.02, 0.02, 0.0199], [0.08, 0.08, 1.0]]\n");
  const BodySource body = read_body(scene);
  EXPECT_GT(reachable_vertices(scene, body).size(), 20U);
  // The reach is 60 mm x 60 mm; an eighth of its diagonal is 10.6 mm.
  for (Eigen::Index t = 0; t < body.surface.triangle.rows(); ++t) {
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector3d a =
          body.surface.position_m.row(body.surface.triangle(t, j));
      const Eigen::Vector3d b =
          body.surface.position_m.row(body.surface.triangle(t, (j + 1) % 3));
      if (scene.reach.box_m->contains(0.5 * (a + b))) {
        EXPECT_LT((b - a).norm(), 0.0107);
      }
    }
  }
  EXPECT_NEAR(enclosed_volume_m3(body.surface), 2e-4, 1e-15);
  ASSERT_FALSE(body.notes.empty());
  EXPECT_NE(body.notes.front().find("0.0106 m"), std::string::npos)
      << body.notes.front();
}

TEST_F(BodySurface, AReachThatMissesTheBodyIsStillRefused) {
  write(kBlock);
  const Scene scene = scene_of("box_m = [[0.02, 0.02, 0.5], [0.08, 0.08, 1.0]]\n");
  EXPECT_THROW((void)reachable_vertices(scene, read_body(scene)), InputError);
}

TEST_F(BodySurface, AnEvenSurfaceIsLeftAlone) {
  const SurfaceMesh ball = icosphere(0.03, 2);
  write_obj(ball, folder_ / "body.obj", "a ball");
  const BodySource body = read_body(scene_of(""));
  EXPECT_EQ(body.surface.triangle, ball.triangle);
}

TEST_F(BodySurface, APartThatNothingHoldsIsNamedBeforeAnyWork) {
  SurfaceMesh high = icosphere(1e-4, 0);
  high.position_m.rowwise() += Eigen::RowVector3d(0.0, 0.0, 0.05);
  write_obj(joined(icosphere(0.03, 2), high), folder_ / "body.obj", "with a speck");
  const Scene scene = scene_of("");
  try {
    (void)read_body(scene);
    FAIL() << "a part that floats was accepted";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("no support holds part 2 of 2"), std::string::npos) << text;
    EXPECT_NE(text.find("--repair=safe"), std::string::npos) << text;
  }
  EXPECT_EQ(read_body(scene, RepairMode::kSafe).surface.triangle.rows(), 320);
}

}  // namespace
}  // namespace palpate
