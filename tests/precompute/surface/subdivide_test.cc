#include "precompute/surface/subdivide.h"

#include <gtest/gtest.h>

#include "precompute/surface/primitive_bodies.h"

namespace palpate {
namespace {

TEST(SubdivideMidpoint, KeepsTheOriginalVerticesFirstAndUnchanged) {
  const SurfaceMesh coarse = organ(2);
  const SurfaceMesh fine = subdivide_midpoint(coarse);
  EXPECT_EQ(fine.position_m.topRows(coarse.position_m.rows()), coarse.position_m);
  EXPECT_EQ(fine.triangle.rows(), 4 * coarse.triangle.rows());
  const Eigen::Index edges = 3 * coarse.triangle.rows() / 2;
  EXPECT_EQ(fine.position_m.rows(), coarse.position_m.rows() + edges);
}

TEST(SubdivideMidpoint, DoesNotChangeTheGeometry) {
  const SurfaceMesh coarse = organ(2);
  const SurfaceMesh fine = subdivide_midpoint(coarse);
  // 1e-13: rounding of a thousand sums.
  EXPECT_NEAR(surface_area_m2(fine) / surface_area_m2(coarse), 1.0, 1e-13);
  EXPECT_NEAR(enclosed_volume_m3(fine) / enclosed_volume_m3(coarse), 1.0, 1e-13);
}

TEST(SubdivideMidpoint, PutsFourTrianglesInThePlaneOfEach) {
  const SurfaceMesh coarse = organ(1);
  const SurfaceMesh fine = subdivide_midpoint(coarse);
  const auto normal = [](const SurfaceMesh& mesh, Eigen::Index t) {
    const Eigen::RowVector3d a = mesh.position_m.row(mesh.triangle(t, 0));
    const Eigen::RowVector3d b = mesh.position_m.row(mesh.triangle(t, 1));
    const Eigen::RowVector3d c = mesh.position_m.row(mesh.triangle(t, 2));
    return Eigen::RowVector3d((b - a).cross(c - a));
  };
  for (Eigen::Index t = 0; t < fine.triangle.rows(); ++t) {
    const Eigen::RowVector3d whole = normal(coarse, t / 4);
    EXPECT_NEAR((4.0 * normal(fine, t) - whole).norm(), 0.0, 1e-12 * whole.norm());
  }
}

TEST(SubdivideMidpoint, KeepsAClosedSurfaceClosed) {
  const SurfaceMesh fine = subdivide_midpoint(icosphere(1.0, 1));
  EXPECT_GE(triangle_neighbours(fine.triangle).minCoeff(), 0);
}

}  // namespace
}  // namespace palpate
