#include "precompute/surface/remesh.h"

#include <numbers>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "precompute/surface/primitive_bodies.h"
#include "precompute/surface/surface_check.h"
#include "tests/support/study_bodies.h"

namespace palpate {
namespace {

TEST(Remesh, MakesEdgesOfTheWantedLength) {
  const SurfaceMesh mesh = organ(3);
  for (const double edge_m : {0.004, 0.008}) {
    const RemeshedSurface made = remesh_surface(mesh, edge_m);
    // Isotropic remeshing ends between 4/5 and 4/3 of the wish.
    EXPECT_NEAR(made.report.edge_mean_m / edge_m, 1.0, 0.2);
    EXPECT_TRUE(check_surface(made.mesh).report.accepted());
    EXPECT_LT(std::abs(made.report.volume_relative), 0.02);
    EXPECT_LT(made.report.displaced_m, 0.5 * edge_m);
    EXPECT_GT(made.report.smallest_angle_rad, 15.0 * kDegree);
  }
}

TEST(Remesh, KeepsSharpEdgesInPlace) {
  const double height_m = 0.03;
  const SurfaceMesh mesh = cylinder(0.02, height_m, 6);
  const RemeshedSurface made = remesh_surface(mesh, 0.003);
  EXPECT_GT(made.report.features, 0U);
  EXPECT_EQ(made.mesh.position_m.col(2).minCoeff(), 0.0);
  EXPECT_EQ(made.mesh.position_m.col(2).maxCoeff(), height_m);
  EXPECT_LT(std::abs(made.report.volume_relative), 0.01);
}

TEST(Remesh, RefusesEdgesLongerThanTheBody) {
  EXPECT_THROW((void)remesh_surface(icosphere(0.01, 3), 0.05), InputError);
}

TEST(Remesh, RefusesWishesOutOfRange) {
  const SurfaceMesh mesh = icosphere(0.01, 1);
  EXPECT_THROW((void)remesh_surface(mesh, 0.0), InputError);
  EXPECT_THROW((void)remesh_surface(mesh, -1.0), InputError);
  EXPECT_THROW((void)remesh_surface(mesh, 1e-7), InputError);
  SurfaceMesh open = mesh;
  open.triangle.conservativeResize(open.triangle.rows() - 1, 3);
  EXPECT_THROW((void)remesh_surface(open, 0.005), InputError);
}

TEST(Remesh, SmoothsSharpPlacesThatAreShorterThanItsEdges) {
  SurfaceMesh mesh = icosphere(0.01, 5);
  mesh.position_m.row(100) *= 1.08;  // a spike of two edges
  const RemeshedSurface made = remesh_surface(mesh, 0.0015);
  EXPECT_EQ(made.report.features, 0U);
  EXPECT_GT(made.report.smallest_angle_rad, 20.0 * std::numbers::pi / 180.0);
  EXPECT_LT(made.report.displaced_m, 9e-4);
}

TEST(Remesh, NamesWhatLeavesSpecksOut) {
  SurfaceMesh speck = icosphere(2e-5, 0);
  speck.position_m.col(0).array() += 0.02;
  try {
    (void)remesh_surface(joined(icosphere(0.01, 3), speck), 0.002);
    FAIL() << "a speck was given new edges";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("--repair=safe"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace palpate
