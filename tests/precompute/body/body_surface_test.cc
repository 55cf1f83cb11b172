#include "precompute/body/body_surface.h"

#include <fstream>

#include <gtest/gtest.h>

#include "formats/base/at.h"
#include "formats/base/error.h"
#include "formats/mesh/obj_writer.h"
#include "precompute/body/meshed_body.h"
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

SurfaceMesh inside_out(SurfaceMesh mesh) {
  mesh.triangle.col(1).swap(mesh.triangle.col(2));
  return mesh;
}

double tets_m3(const TetMesh& mesh, std::int32_t region) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < mesh.tet.rows(); ++t) {
    sum += mesh.region[at(t)] == region ? tet_volume_m3(mesh, t) : 0.0;
  }
  return sum;
}

TEST_F(BodySurface, AnInnerWallOfTheFileIsACavityOfTheBody) {
  const SurfaceMesh ball = icosphere(0.03, 3);
  const SurfaceMesh wall = icosphere(0.015, 2);
  const Scene scene = scene_of("");
  for (const bool as_outside : {false, true}) {
    write_obj(joined(as_outside ? wall : inside_out(wall), ball), folder_ / "body.obj",
              "hollow");
    if (as_outside) {
      EXPECT_THROW((void)read_body(scene), InputError);
    }
    const BodySource body =
        read_body(scene, as_outside ? RepairMode::kSafe : RepairMode::kOff);
    EXPECT_EQ(body.surface.triangle, ball.triangle);
    ASSERT_EQ(body.inner.size(), 1U);
    EXPECT_TRUE(body.inner[0].cavity);
    EXPECT_EQ(body.inner[0].name, "cavity 1 of body.obj");
    const FilledBody filled = filled_body(body, body.surface);
    EXPECT_NEAR(
        tets_m3(filled.tets, 0) / (enclosed_volume_m3(ball) - enclosed_volume_m3(wall)),
        1.0, 1e-6);
    EXPECT_EQ(tets_m3(filled.tets, 1), 0.0);
  }
}

TEST_F(BodySurface, AnInnerWallThatTheSceneNamesIsItsInclusion) {
  const SurfaceMesh ball = icosphere(0.03, 3);
  const SurfaceMesh wall = icosphere(0.015, 2);
  write_obj(wall, folder_ / "wall.obj", "an inclusion");
  const std::string named = R"(
[[inclusion]]
name = "stone"
mesh = "wall.obj"
length_unit = "m"
[[material]]
region = "stone"
law = "linear"
youngs_modulus_pa = 60000.0
poissons_ratio = 0.4
)";
  for (const SurfaceMesh& inner : {wall, inside_out(wall)}) {
    write_obj(joined(ball, inner), folder_ / "body.obj", "with a stone");
    const BodySource body = read_body(scene_of(named));
    EXPECT_EQ(body.surface.triangle, ball.triangle);
    ASSERT_EQ(body.inner.size(), 1U);
    EXPECT_FALSE(body.inner[0].cavity);
    const FilledBody filled = filled_body(body, body.surface);
    EXPECT_NEAR(tets_m3(filled.tets, 1) / enclosed_volume_m3(wall), 1.0, 1e-6);
    EXPECT_NE(body.notes.front().find("inclusion \"stone\""), std::string::npos);
  }
}

TEST_F(BodySurface, AnIslandInACavityIsNamedOrFilled) {
  const SurfaceMesh wall = inside_out(icosphere(0.02, 2));
  SurfaceMesh island = icosphere(0.005, 2);
  island.position_m.col(2).array() += 0.01;
  const SurfaceMesh mesh = joined(joined(icosphere(0.03, 3), wall), island);
  write_obj(mesh, folder_ / "body.obj", "an island");
  try {
    (void)read_body(scene_of(""));
    FAIL() << "an island that floats was accepted";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("no support holds part 3 of 3"), std::string::npos) << text;
    EXPECT_NE(text.find("which lies in a cavity"), std::string::npos) << text;
  }
  const BodySource body =
      read_body(scene_of("[[support]]\npatch = { center_m = [0.0, 0.0, 0.015], "
                         "radius_m = 0.003 }\n"));
  EXPECT_NEAR(
      tets_m3(filled_body(body, body.surface).tets, 0) / enclosed_volume_m3(mesh), 1.0,
      1e-6);
}

}  // namespace
}  // namespace palpate
