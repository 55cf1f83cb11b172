// Bodies at the ends of what can be meshed: right, or refused in one sentence.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "precompute/surface/primitive_bodies.h"
#include "precompute/surface/subdivide.h"
#include "precompute/surface/surface_check.h"
#include "precompute/tets/tetrahedralise.h"
#include "tests/support/study_bodies.h"

namespace palpate {
namespace {

SurfaceMesh box(const Eigen::RowVector3d& size_m, int levels) {
  SurfaceMesh mesh;
  mesh.position_m.resize(8, 3);
  for (int v = 0; v < 8; ++v) {
    mesh.position_m.row(v) << (v & 1), ((v & 2) / 2), ((v & 4) / 4);
  }
  mesh.position_m.array().rowwise() *= size_m.array();
  mesh.triangle.resize(12, 3);
  mesh.triangle << 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,  //
      2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5;
  for (int level = 0; level < levels; ++level) {
    mesh = subdivide_midpoint(mesh);
  }
  return mesh;
}

// Meshed with positive tets of the right volume, or an Error of one line.
void expect_right_or_refused(const SurfaceMesh& surface) {
  try {
    const CheckedSurface checked = require_body(surface, "body");
    const TetMesh mesh = tetrahedralise(checked.mesh);
    const TetQuality quality = tet_quality(mesh);
    EXPECT_GT(quality.smallest_volume_m3, 0.0);
    EXPECT_NEAR(quality.volume_m3 / enclosed_volume_m3(checked.mesh), 1.0, 1e-9);
    EXPECT_EQ(mesh.position_m.topRows(surface.position_m.rows()), surface.position_m);
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_GT(text.size(), 20U);
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    ::testing::Test::RecordProperty("refused", text);
  }
}

TEST(ExtremeBodies, OfAMicrometreAndOfAHundredMetresGetTheSameTets) {
  const TetMesh one = tetrahedralise(icosphere(1.0, 2));
  // Powers of two, so that the bodies are the same but for scale.
  for (const double radius_m : {std::exp2(-21), std::exp2(6)}) {
    const SurfaceMesh surface = icosphere(radius_m, 2);
    ASSERT_TRUE(check_surface(surface).report.accepted());
    const TetMesh mesh = tetrahedralise(surface);
    EXPECT_EQ(mesh.tet, one.tet);
    EXPECT_EQ(mesh.position_m, radius_m * one.position_m);
    EXPECT_GT(tet_quality(mesh).smallest_dihedral_rad, 5.0 * kDegree);
  }
}

TEST(ExtremeBodies, AThinPlateIsFilled) {
  const SurfaceMesh plate = box({0.2, 0.2, 0.001}, 5);
  ASSERT_TRUE(check_surface(plate).report.accepted());
  const TetQuality quality = tet_quality(tetrahedralise(plate));
  EXPECT_NEAR(quality.volume_m3 / (0.2 * 0.2 * 0.001), 1.0, 1e-9);
}

TEST(ExtremeBodies, ANeedleIsFilledOrRefused) {
  expect_right_or_refused(box({1.0, 0.001, 0.001}, 0));
  expect_right_or_refused(box({1.0, 0.001, 0.001}, 3));
  expect_right_or_refused(ellipsoid({1.0, 0.001, 0.001}, 3));
}

TEST(ExtremeBodies, NeedleTrianglesAreFilledOrRefused) {
  // One vertex of a sphere moved to a thousandth of an edge from its neighbour.
  SurfaceMesh mesh = icosphere(1.0, 2);
  const Eigen::RowVector3d from = mesh.position_m.row(mesh.triangle(0, 1));
  mesh.position_m.row(mesh.triangle(0, 0)) =
      from + 0.001 * (mesh.position_m.row(mesh.triangle(0, 0)) - from);
  expect_right_or_refused(mesh);
}

TEST(ExtremeBodies, NearlyFlatDihedralsAreFilledOrRefused) {
  for (const double height_m : {1e-3, 1e-6, 1e-9}) {
    // Two square pyramids of almost no height, base to base.
    SurfaceMesh mesh;
    mesh.position_m.resize(6, 3);
    mesh.position_m << 1, 0, 0, 0, 1, 0, -1, 0, 0, 0, -1, 0, 0, 0, height_m, 0, 0,
        -height_m;
    mesh.triangle.resize(8, 3);
    mesh.triangle << 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4,  //
        1, 0, 5, 2, 1, 5, 3, 2, 5, 0, 3, 5;
    expect_right_or_refused(mesh);
  }
}

TEST(ExtremeBodies, TwoVerticesAlmostAtOnePlaceAreFilledOrRefused) {
  for (const double apart : {1e-8, 1e-9, 1e-12}) {
    SurfaceMesh mesh = icosphere(1.0, 2);
    const Eigen::RowVector3d from = mesh.position_m.row(mesh.triangle(0, 1));
    mesh.position_m.row(mesh.triangle(0, 0)) =
        from + apart * (mesh.position_m.row(mesh.triangle(0, 0)) - from).normalized();
    expect_right_or_refused(mesh);
  }
}

TEST(ExtremeBodies, ThinShellsAreFilled) {
  const double outer_m = 1.0;
  const double inner_m = 0.99;
  const TetMesh shell = tetrahedralise(
      icosphere(outer_m, 4), {},
      std::vector<InnerSurface>{{.surface = icosphere(inner_m, 4), .cavity = true}});
  const double wanted_m3 = enclosed_volume_m3(icosphere(outer_m, 4)) -
                           enclosed_volume_m3(icosphere(inner_m, 4));
  EXPECT_NEAR(tet_quality(shell).volume_m3 / wanted_m3, 1.0, 1e-9);
}

}  // namespace
}  // namespace palpate
