#include "precompute/surface/primitive_bodies.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/mesh/surface_reader.h"
#include "tests/support/study_bodies.h"

namespace palpate {
namespace {

using std::numbers::pi;

// V - E + F of a closed surface in one part and without handles; each edge has exactly
// one triangle on either side, run through in opposite directions.
void expect_sphere_like(const SurfaceMesh& mesh) {
  EXPECT_EQ(mesh.position_m.rows() - mesh.triangle.rows() / 2, 2);
  EXPECT_EQ(triangle_neighbours(mesh.triangle).minCoeff(), 0);
  EXPECT_GT(enclosed_volume_m3(mesh), 0.0);
}

double smallest_angle_deg(const SurfaceMesh& mesh) {
  double smallest = pi;
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    for (int j = 0; j < 3; ++j) {
      const Eigen::RowVector3d p = mesh.position_m.row(mesh.triangle(t, j));
      const Eigen::RowVector3d a =
          mesh.position_m.row(mesh.triangle(t, (j + 1) % 3)) - p;
      const Eigen::RowVector3d b =
          mesh.position_m.row(mesh.triangle(t, (j + 2) % 3)) - p;
      smallest = std::min(smallest, std::atan2(a.cross(b).norm(), a.dot(b)));
    }
  }
  return smallest * 180.0 / pi;
}

TEST(Icosphere, HasAllVerticesAtTheRadius) {
  const SurfaceMesh sphere = icosphere(0.02, 3);
  ASSERT_EQ(sphere.position_m.rows(), 642);
  expect_sphere_like(sphere);
  const Eigen::VectorXd radius_m = sphere.position_m.rowwise().norm();
  EXPECT_NEAR(radius_m.minCoeff(), 0.02, 1e-16);
  EXPECT_NEAR(radius_m.maxCoeff(), 0.02, 1e-16);
}

TEST(Icosphere, VolumeConvergesWithTheSquareOfTheEdge) {
  const double exact = 4.0 / 3.0 * pi;
  const double coarse = exact - enclosed_volume_m3(icosphere(1.0, 3));
  const double fine = exact - enclosed_volume_m3(icosphere(1.0, 4));
  EXPECT_GT(fine, 0.0);
  EXPECT_NEAR(coarse / fine, 4.0, 0.05);
}

TEST(Ellipsoid, VolumeIsTheSpheresTimesItsAxes) {
  const SurfaceMesh body = ellipsoid({0.03, 0.02, 0.01}, 3);
  EXPECT_NEAR(enclosed_volume_m3(body),
              0.03 * 0.02 * 0.01 * enclosed_volume_m3(icosphere(1.0, 3)), 1e-18);
}

TEST(Organ, IsAClosedBodyOfTheSizeThatItSays) {
  for (const int levels : {3, 4}) {
    const SurfaceMesh body = organ(levels);
    expect_sphere_like(body);
    const Eigen::Vector3d size_m = bounding_box(body).sizes();
    EXPECT_NEAR(size_m.x(), 0.14, 0.01);
    EXPECT_NEAR(size_m.y(), 0.09, 0.01);
    EXPECT_NEAR(size_m.z(), 0.045, 0.005);
    EXPECT_EQ(body.position_m.col(2).minCoeff(), 0.0);
    EXPECT_GT(smallest_angle_deg(body), 15.0);
  }
}

TEST(Organ, IsTheBodyThatTheDemoShips) {
  const SurfaceMesh shipped = read_surface("data/organ.obj", "m");
  const SurfaceMesh made = organ();
  EXPECT_EQ(shipped.triangle, made.triangle);
  ASSERT_EQ(shipped.position_m.rows(), made.position_m.rows());
  // 1e-12 m: another mathematical library may round sin, exp and tanh another way.
  EXPECT_LT((shipped.position_m - made.position_m).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(GradedBlock, HasExactVolumeAndArea) {
  const SurfaceMesh block = graded_block(0.1, 0.05, 0.004, 8);
  expect_sphere_like(block);
  EXPECT_NEAR(enclosed_volume_m3(block), 0.2 * 0.2 * 0.05, 1e-15);
  EXPECT_NEAR(surface_area_m2(block), 2 * 0.2 * 0.2 + 4 * 0.2 * 0.05, 1e-14);
}

TEST(GradedBlock, VertexZeroIsTheMiddleOfTheTopInTheFinestPart) {
  const SurfaceMesh block = graded_block(0.1, 0.05, 0.004, 8);
  EXPECT_EQ(block.position_m.row(0), Eigen::RowVector3d(0, 0, 0));
  const auto neighbours = vertex_neighbours(block.position_m.rows(), block.triangle);
  for (const std::int32_t other : neighbours[0]) {
    const double distance_m = block.position_m.row(other).norm();
    EXPECT_LE(distance_m, 0.001 * std::numbers::sqrt2 + 1e-15);
  }
}

TEST(GradedBlock, TrianglesStayWellShapedHoweverStrongTheGrading) {
  EXPECT_GT(smallest_angle_deg(graded_block(1.0, 1.0, 0.001, 12)), 35.0);
}

TEST(Cylinder, VolumeIsThatOfItsPolygonalPrism) {
  const int rings = 5;
  const SurfaceMesh body = cylinder(0.01, 0.03, rings);
  expect_sphere_like(body);
  const int sides = 6 * rings;
  const double base_m2 = 0.5 * sides * 1e-4 * std::sin(2 * pi / sides);
  EXPECT_NEAR(enclosed_volume_m3(body), base_m2 * 0.03, 1e-18);
  EXPECT_GT(smallest_angle_deg(body), 35.0);
}

TEST(PrimitiveBodies, RefuseSizesThatMakeNoBody) {
  EXPECT_THROW((void)icosphere(0.0, 2), InputError);
  EXPECT_THROW((void)icosphere(std::nan(""), 2), InputError);
}

}  // namespace
}  // namespace palpate
