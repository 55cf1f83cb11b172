#include "formats/mesh/surface_mesh.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/small_database.h"

namespace palpate {
namespace {

SurfaceMesh unit_cube() {
  SurfaceMesh mesh;
  mesh.position_m.resize(8, 3);
  for (int i = 0; i < 8; ++i) {
    mesh.position_m.row(i) << (i & 1), (i >> 1 & 1), (i >> 2 & 1);
  }
  mesh.triangle.resize(12, 3);
  mesh.triangle << 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7,
      3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5;
  return mesh;
}

TEST(SurfaceMesh, MeasuresOfACube) {
  SurfaceMesh mesh = unit_cube();
  mesh.position_m.rowwise() += Eigen::RowVector3d(10.0, -20.0, 30.0);
  EXPECT_NEAR(enclosed_volume_m3(mesh), 1.0, 1e-12);
  EXPECT_NEAR(surface_area_m2(mesh), 6.0, 1e-12);
  EXPECT_EQ(bounding_box(mesh).min(), Eigen::Vector3d(10.0, -20.0, 30.0));
  EXPECT_EQ(bounding_box(mesh).sizes(), Eigen::Vector3d::Ones());
  // Each face has four sides and one diagonal that counts twice.
  EXPECT_NEAR(mean_edge_m(mesh), (4.0 + 2.0 * std::sqrt(2.0)) / 6.0, 1e-12);
}

TEST(SurfaceMesh, AnInsideOutSurfaceHasNegativeVolume) {
  SurfaceMesh mesh = unit_cube();
  mesh.triangle.col(0).swap(mesh.triangle.col(1));
  EXPECT_NEAR(enclosed_volume_m3(mesh), -1.0, 1e-12);
}

TEST(SurfaceMesh, NormalsOfACubeAreItsDiagonalsHoweverItIsTriangulated) {
  const SurfaceMesh mesh = unit_cube();
  const Points normal = vertex_normals(mesh);
  for (Eigen::Index v = 0; v < 8; ++v) {
    const Eigen::RowVector3d diagonal =
        (mesh.position_m.row(v) - Eigen::RowVector3d::Constant(0.5)).normalized();
    EXPECT_LT((normal.row(v) - diagonal).norm(), 1e-15) << v;
  }
}

TEST(SurfaceMesh, AVertexWithoutTriangleHasNoNormal) {
  SurfaceMesh mesh = unit_cube();
  mesh.position_m.conservativeResize(9, 3);
  mesh.position_m.row(8).setConstant(7.0);
  EXPECT_EQ(vertex_normals(mesh).row(8).norm(), 0.0);
}

TEST(SurfaceMesh, AnEmptyMeshMeasuresNothing) {
  const SurfaceMesh mesh;
  EXPECT_EQ(enclosed_volume_m3(mesh), 0.0);
  EXPECT_EQ(surface_area_m2(mesh), 0.0);
  EXPECT_EQ(mean_edge_m(mesh), 0.0);
  EXPECT_TRUE(bounding_box(mesh).isEmpty());
}

TEST(SurfaceMesh, NeighboursAcrossEdgesAreMutualAndShareTheEdge) {
  const Triangles triangle = octahedron(1.0).triangle;
  const Triangles neighbour = triangle_neighbours(triangle);
  for (Eigen::Index t = 0; t < triangle.rows(); ++t) {
    for (int j = 0; j < 3; ++j) {
      const Eigen::Index other = neighbour(t, j);
      ASSERT_GE(other, 0);
      EXPECT_TRUE((neighbour.row(other).array() == static_cast<std::int32_t>(t)).any());
      for (const int corner : {j, (j + 1) % 3}) {
        EXPECT_TRUE((triangle.row(other).array() == triangle(t, corner)).any());
      }
    }
  }
}

TEST(SurfaceMesh, ABorderHasNoNeighbour) {
  Triangles one(1, 3);
  one << 0, 1, 2;
  EXPECT_EQ(triangle_neighbours(one), Triangles::Constant(1, 3, -1));
}

TEST(SurfaceMesh, VerticesOfAnOctahedronKnowAllButTheOpposite) {
  const auto neighbour = vertex_neighbours(6, octahedron(1.0).triangle);
  EXPECT_EQ(neighbour[0], (std::vector<std::int32_t>{2, 3, 4, 5}));
  EXPECT_EQ(neighbour[4], (std::vector<std::int32_t>{0, 1, 2, 3}));
}

}  // namespace
}  // namespace palpate
