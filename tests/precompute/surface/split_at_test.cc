#include "precompute/surface/split_at.h"

#include <array>

#include <gtest/gtest.h>

#include "precompute/surface/primitive_bodies.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

const std::array<Eigen::Vector3d, 4> kPlaces{
    {{0.2, 0.3, 0.5}, {0.0, 0.4, 0.6}, {0.7, 0.0, 0.3}, {0.5, 0.5, 0.0}}};

TEST(SplitAt, AddsOneVertexThereAndKeepsTheGeometry) {
  const SurfaceMesh body = organ(2);
  for (const Eigen::Vector3d& share : kPlaces) {
    const SurfacePoint place{.triangle = 17, .area_coordinate = share};
    const SurfaceMesh split = split_at(body, place);
    const Eigen::Index n = body.position_m.rows();
    ASSERT_EQ(split.position_m.rows(), n + 1);
    EXPECT_EQ(split.triangle.rows(), body.triangle.rows() + 2);
    EXPECT_EQ(split.position_m.topRows(n), body.position_m);
    Eigen::RowVector3d at = Eigen::RowVector3d::Zero();
    for (int j = 0; j < 3; ++j) {
      at += share(j) * body.position_m.row(body.triangle(17, j));
    }
    EXPECT_LT((split.position_m.row(n) - at).norm(), 1e-15);
    // 1e-13: rounding of a thousand sums.
    EXPECT_NEAR(surface_area_m2(split) / surface_area_m2(body), 1.0, 1e-13);
    EXPECT_NEAR(enclosed_volume_m3(split) / enclosed_volume_m3(body), 1.0, 1e-13);
    EXPECT_GE(triangle_neighbours(split.triangle).minCoeff(), 0);
    EXPECT_LT(
        (vertex_normals(split).topRows(n) - vertex_normals(body)).cwiseAbs().maxCoeff(),
        1e-12);
  }
}

TEST(SplitAt, CutsOneTriangleAtABorder) {
  const SurfaceMesh flat = plate(0.1, 2);
  const Triangles across = triangle_neighbours(flat.triangle);
  for (std::int32_t t = 0; t < flat.triangle.rows(); ++t) {
    for (int j = 0; j < 3; ++j) {
      if (across(t, j) < 0) {
        SurfacePoint place{.triangle = t};
        place.area_coordinate(j) = 0.25;
        place.area_coordinate((j + 1) % 3) = 0.75;
        const SurfaceMesh split = split_at(flat, place);
        EXPECT_EQ(split.triangle.rows(), flat.triangle.rows() + 1);
        EXPECT_NEAR(surface_area_m2(split), 0.01, 1e-15);
      }
    }
  }
}

}  // namespace
}  // namespace palpate
