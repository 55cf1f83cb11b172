#include "precompute/surface/surface_distance.h"

#include <cmath>

#include <gtest/gtest.h>

namespace palpate {
namespace {

SurfaceMesh square(double half_m, double z_m) {
  SurfaceMesh mesh;
  mesh.position_m.resize(4, 3);
  mesh.position_m << -half_m, -half_m, z_m, half_m, -half_m, z_m, half_m, half_m, z_m,
      -half_m, half_m, z_m;
  mesh.triangle.resize(2, 3);
  mesh.triangle << 0, 1, 2, 0, 2, 3;
  return mesh;
}

SurfaceMesh cube(double half_m) {
  SurfaceMesh mesh;
  mesh.position_m.resize(8, 3);
  for (Eigen::Index v = 0; v < 8; ++v) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      mesh.position_m(v, k) = ((v >> k) & 1) != 0 ? half_m : -half_m;
    }
  }
  mesh.triangle.resize(12, 3);
  mesh.triangle << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6,
      7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5;
  return mesh;
}

constexpr double kRounding = 1e-15;

TEST(SurfaceDistance, IsTheGapOfParallelSquaresWhereOneFacesTheOther) {
  const SurfaceMesh small = square(0.01, 0.0);
  const SurfaceMesh wide = square(0.02, 0.003);
  EXPECT_NEAR(distance_to_surface_m(small, wide), 0.003, kRounding);
  // A corner of the wide one is beside the small one by 0.01 along both sides.
  EXPECT_NEAR(distance_to_surface_m(wide, small), std::sqrt(2e-4 + 9e-6), kRounding);
}

TEST(SurfaceDistance, OfACubeInACubeIsTheGapInAndTheCornersOut) {
  const SurfaceMesh inner = cube(0.01);
  const SurfaceMesh outer = cube(0.013);
  EXPECT_NEAR(distance_to_surface_m(inner, outer), 0.003, kRounding);
  EXPECT_NEAR(distance_to_surface_m(outer, inner), 0.003 * std::sqrt(3.0), kRounding);
  EXPECT_NEAR(distance_to_surface_m(inner, inner), 0.0, kRounding);
}

// A triangle whose corners all lie on the target: only its middle is away from it.
TEST(SurfaceDistance, CountsTheMiddlesOfTriangles) {
  const SurfaceMesh bottom = square(0.01, 0.0);
  SurfaceMesh lid = bottom;
  lid.triangle.resize(1, 3);
  lid.triangle << 0, 1, 2;
  SurfaceMesh sides = bottom;
  sides.position_m.conservativeResize(7, 3);
  sides.position_m.bottomRows(3) = sides.position_m.topRows(3);
  sides.position_m.bottomRows(3).col(2).array() -= 0.1;
  sides.triangle.resize(6, 3);
  sides.triangle << 0, 4, 5, 0, 5, 1, 1, 5, 6, 1, 6, 2, 2, 6, 4, 2, 4, 0;
  // A third of the height sqrt(2) a above the longest side, 2 a / 3 off the others.
  EXPECT_NEAR(distance_to_surface_m(lid, sides), 0.01 * std::sqrt(2.0) / 3.0,
              kRounding);
}

TEST(SurfaceDistance, PassesOverVerticesOfNoTriangle) {
  const SurfaceMesh plane = square(0.01, 0.0);
  SurfaceMesh with_stray = square(0.01, 0.003);
  with_stray.position_m.conservativeResize(5, 3);
  with_stray.position_m.row(4) << 1.0, 2.0, 3.0;
  EXPECT_NEAR(distance_to_surface_m(with_stray, plane), 0.003, kRounding);
  EXPECT_NEAR(distance_to_surface_m(plane, with_stray), 0.003, kRounding);
  with_stray.triangle.resize(0, 3);
  EXPECT_EQ(distance_to_surface_m(with_stray, plane), 0.0);
}

}  // namespace
}  // namespace palpate
