// A scene's body as its files describe it, mended where that is asked for.
#include "precompute/body/scene_body.h"

#include <algorithm>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/mesh/obj_writer.h"
#include "precompute/surface/primitive_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

// A scene of a body in a file of its own.
class BodySources : public testing::Test {
 protected:
  Scene scene_of(const SurfaceMesh& surface) const {
    write_obj(surface, folder_ / "body.obj", "a body");
    std::ofstream(folder_ / "scene.toml") << R"([body]
mesh = "body.obj"
length_unit = "m"
[[material]]
region = "body"
law = "linear"
youngs_modulus_pa = 6000.0
poissons_ratio = 0.4
[[support]]
box_m = [[-1.0, -1.0, -1.0], [1.0, 1.0, -0.02]]
[[tool]]
name = "tip"
shape = "sphere"
radius_m = 0.01
[reach]
depth_max_m = 0.005
)";
    return read_scene(folder_ / "scene.toml");
  }

  ScratchFolder folder_;
};

// Without its first triangle: a hole of less than a tenth of the body.
SurfaceMesh holed() {
  SurfaceMesh mesh = icosphere(0.03, 3);
  mesh.triangle = mesh.triangle.bottomRows(mesh.triangle.rows() - 1).eval();
  return mesh;
}

bool any_contains(const std::vector<std::string>& notes, const std::string& what) {
  return std::any_of(notes.begin(), notes.end(), [&](const std::string& note) {
    return note.find(what) != std::string::npos;
  });
}

TEST_F(BodySources, AHoleIsRefusedWithWhatToTry) {
  try {
    (void)read_body(scene_of(holed()));
    FAIL() << "an open surface was taken for a body";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("body.obj"), std::string::npos) << text;
    EXPECT_NE(text.find("--repair=safe"), std::string::npos) << text;
  }
}

TEST_F(BodySources, SafeRepairClosesAHoleKeepsVerticesAndSaysSo) {
  const BodySource body = read_body(scene_of(holed()), RepairMode::kSafe);
  const SurfaceMesh whole = icosphere(0.03, 3);
  ASSERT_EQ(body.surface.triangle.rows(), whole.triangle.rows());
  EXPECT_LT((body.surface.position_m - whole.position_m).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(body.normal.rows(), whole.position_m.rows());
  EXPECT_TRUE(any_contains(body.notes, "repair"));
}

TEST_F(BodySources, AGoodBodyIsNotRepaired) {
  for (const RepairMode mode :
       {RepairMode::kOff, RepairMode::kSafe, RepairMode::kWrap}) {
    const BodySource body = read_body(scene_of(icosphere(0.03, 2)), mode);
    EXPECT_EQ(body.surface.position_m.rows(), 162);
    EXPECT_TRUE(body.notes.empty());
  }
}

TEST_F(BodySources, WrapGivesNewVerticesWithNormalsAndSaysSo) {
  SurfaceMesh crossing = icosphere(0.03, 2);
  // One vertex pushed through the other side.
  crossing.position_m.row(0) *= -1.2;
  const BodySource body = read_body(scene_of(crossing), RepairMode::kWrap);
  EXPECT_EQ(body.normal.rows(), body.surface.position_m.rows());
  EXPECT_TRUE(any_contains(body.notes, "THE SURFACE IS NEW"));
}

TEST_F(BodySources, ASupportHoldsTheCapThatLiesInIt) {
  const Scene scene = scene_of(icosphere(0.03, 3));
  const std::vector<double> area_m2 =
      supported_areas_m2(scene, read_body(scene).surface);
  ASSERT_EQ(area_m2.size(), 1U);
  const double cap_m2 = 2.0 * std::numbers::pi * 0.03 * 0.01;
  EXPECT_NEAR(area_m2[0] / cap_m2, 1.0, 0.03);  // the surface is of flat triangles
}

TEST_F(BodySources, ASupportThatHoldsNothingIsRefused) {
  Scene scene = scene_of(icosphere(0.03, 2));
  scene.support.push_back(scene.support.front());
  scene.support.back().box_m =
      Eigen::AlignedBox3d(Eigen::Vector3d(5, 5, 5), Eigen::Vector3d(6, 6, 6));
  try {
    (void)read_body(scene);
    FAIL() << "a support far away was taken";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("support 2 of 2 holds nothing"), std::string::npos) << text;
  }
  // A patch between vertices is not nothing.
  scene.support.back().box_m.reset();
  const SurfaceMesh ball = read_body(scene_of(icosphere(0.03, 2))).surface;
  Eigen::Vector3d inside = Eigen::Vector3d::Zero();
  for (const std::int32_t corner : ball.triangle.row(0)) {
    inside += ball.position_m.row(corner).transpose() / 3.0;
  }
  scene.support.back().patch = SceneBall{inside, 0.004};
  EXPECT_NO_THROW((void)read_body(scene));
}

TEST_F(BodySources, NeedleTrianglesAreNoted) {
  SurfaceMesh flat = icosphere(0.03, 2);
  flat.position_m.col(0) *= 0.05;
  flat.position_m.col(2) *= 1.5;
  EXPECT_TRUE(any_contains(read_body(scene_of(flat)).notes, "poor surface"));
}

}  // namespace
}  // namespace palpate
