#include "formats/mesh/surface_search.h"

#include <array>
#include <limits>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

Eigen::Matrix3d corners(const SurfaceMesh& mesh, Eigen::Index t) {
  Eigen::Matrix3d corner;
  for (int j = 0; j < 3; ++j) {
    corner.row(j) = mesh.position_m.row(mesh.triangle(t, j));
  }
  return corner;
}

double brute_force_distance(const SurfaceMesh& mesh, const Eigen::Vector3d& p) {
  double best = std::numeric_limits<double>::infinity();
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    best = std::min(best, nearest_in_triangle(corners(mesh, t), p).distance_m);
  }
  return best;
}

class RandomPoints {
 public:
  Eigen::Vector3d in_cube(double half_side) {
    std::uniform_real_distribution<double> side(-half_side, half_side);
    return {side(generator_), side(generator_), side(generator_)};
  }

  // On a shell about the origin.
  Eigen::Vector3d at_radius(double radius) {
    Eigen::Vector3d p = in_cube(1.0);
    while (p.norm() > 1.0 || p.norm() < 0.1) {
      p = in_cube(1.0);
    }
    return radius * p.normalized();
  }

 private:
  std::mt19937 generator_{20240501};
};

TEST(NearestInTriangle, IsNotBeatenByAnyPointOfTheTriangle) {
  RandomPoints random;
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::Matrix3d corner;
    for (int j = 0; j < 3; ++j) {
      corner.row(j) = random.in_cube(1.0).transpose();
    }
    const Eigen::Vector3d p = random.in_cube(2.0);
    const SurfacePoint nearest = nearest_in_triangle(corner, p);
    EXPECT_GE(nearest.area_coordinate.minCoeff(), 0.0);
    EXPECT_NEAR(nearest.area_coordinate.sum(), 1.0, 1e-12);
    EXPECT_LT(
        (corner.transpose() * nearest.area_coordinate - nearest.position_m).norm(),
        1e-12);
    for (int i = 0; i <= 20; ++i) {
      for (int j = 0; i + j <= 20; ++j) {
        const Eigen::Vector3d n(i / 20.0, j / 20.0, (20 - i - j) / 20.0);
        ASSERT_LE(nearest.distance_m, (p - corner.transpose() * n).norm() + 1e-12);
      }
    }
  }
}

TEST(NearestInTriangle, TakesATriangleWithoutAreaAsItsEdges) {
  Eigen::Matrix3d corner;
  corner << 0, 0, 0, 1, 0, 0, 2, 0, 0;
  const SurfacePoint point = nearest_in_triangle(corner, {1.5, 1.0, 0.0});
  EXPECT_NEAR(point.distance_m, 1.0, 1e-15);
  EXPECT_NEAR((point.position_m - Eigen::Vector3d(1.5, 0, 0)).norm(), 0.0, 1e-15);
  EXPECT_EQ(nearest_in_triangle(Eigen::Matrix3d::Zero(), {0, 0, 2}).distance_m, 2.0);
}

TEST(SurfaceSearch, FindsWhatLookingAtEveryTriangleFinds) {
  RandomPoints random;
  for (const SurfaceMesh& mesh : {sphere_surface(0.05, 3), plate(0.1, 12)}) {
    const SurfaceSearch search(mesh);
    for (int trial = 0; trial < 500; ++trial) {
      const Eigen::Vector3d p = random.in_cube(0.1);
      const SurfacePoint nearest = search.nearest(p);
      ASSERT_GE(nearest.triangle, 0);
      EXPECT_NEAR(nearest.distance_m, brute_force_distance(mesh, p), 1e-15);
      EXPECT_NEAR((nearest.position_m - p).norm(), nearest.distance_m, 1e-15);
    }
  }
}

TEST(SurfaceSearch, WalksToTheGlobalAnswerOnAConvexBody) {
  RandomPoints random;
  const SurfaceMesh mesh = sphere_surface(0.05, 3);
  const SurfaceSearch search(mesh);
  std::mt19937 generator(7);
  std::uniform_int_distribution<std::int32_t> any(
      0, static_cast<std::int32_t>(mesh.triangle.rows()) - 1);
  for (int trial = 0; trial < 500; ++trial) {
    const Eigen::Vector3d p = random.at_radius(0.051 + 0.0001 * trial);
    EXPECT_NEAR(search.walk(p, any(generator)).distance_m, search.nearest(p).distance_m,
                1e-15);
  }
}

TEST(SurfaceSearch, StaysOnItsSideOfAThinBodyWhenWalking) {
  // Two plates back to back, 4 mm apart: pressed 3 mm into the upper one, the lower one
  // is nearer, but the contact belongs to the upper one.
  SurfaceMesh mesh = plate(0.1, 4);
  const Eigen::Index n = mesh.position_m.rows();
  const Eigen::Index m = mesh.triangle.rows();
  mesh.position_m.conservativeResize(2 * n, 3);
  mesh.position_m.bottomRows(n) = mesh.position_m.topRows(n);
  mesh.position_m.bottomRows(n).col(2).setConstant(-0.004);
  mesh.triangle.conservativeResize(2 * m, 3);
  mesh.triangle.bottomRows(m) =
      mesh.triangle.topRows(m).array() + static_cast<std::int32_t>(n);
  const SurfaceSearch search(mesh);
  const Eigen::Vector3d above(0.01, 0.013, 0.001);
  const Eigen::Vector3d pressed(0.01, 0.013, -0.003);
  const SurfacePoint contact = search.nearest(above);
  EXPECT_NEAR(search.nearest(pressed).position_m.z(), -0.004, 1e-15);
  EXPECT_NEAR(search.walk(pressed, contact.triangle).position_m.z(), 0.0, 1e-15);
}

TEST(SurfaceSearch, ListsTheTrianglesAroundATriangleEdgeNeighboursFirst) {
  const SurfaceMesh mesh = sphere_surface(1.0, 2);
  const SurfaceSearch search(mesh);
  for (std::int32_t t = 0; t < mesh.triangle.rows(); ++t) {
    std::array<std::int32_t, 32> ring{};
    const std::size_t count = search.around(t, ring);
    std::set<std::int32_t> expected;
    for (std::int32_t other = 0; other < mesh.triangle.rows(); ++other) {
      for (int j = 0; j < 9; ++j) {
        if (other != t && mesh.triangle(t, j / 3) == mesh.triangle(other, j % 3)) {
          expected.insert(other);
        }
      }
    }
    EXPECT_EQ(std::set(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(count)),
              expected);
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_EQ(ring[j], search.neighbours()(t, static_cast<Eigen::Index>(j)));
    }
  }
}

TEST(SurfaceSearch, HasNoAnswerForAPositionThatIsNotANumber) {
  const SurfaceMesh mesh = plate(0.1, 2);
  const SurfaceSearch search(mesh);
  EXPECT_EQ(search.nearest({0.0, std::nan(""), 0.0}).triangle, -1);
  const SurfaceMesh nothing;
  EXPECT_EQ(SurfaceSearch(nothing).nearest({0, 0, 0}).triangle, -1);
}

}  // namespace
}  // namespace palpate
