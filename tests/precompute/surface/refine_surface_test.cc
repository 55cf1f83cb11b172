#include "precompute/surface/refine_surface.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "precompute/surface/primitive_bodies.h"
#include "precompute/surface/surface_check.h"
#include "tests/support/study_bodies.h"

namespace palpate {
namespace {

constexpr Eigen::Index kMany = 1'000'000;

EdgeLength uniform(double edge_m) {
  return [edge_m](const Eigen::Vector3d&) {
    return edge_m;
  };
}

// Fine at the body's first vertex, growing away from it.
EdgeLength graded(const SurfaceMesh& mesh, double finest_m) {
  const Eigen::Vector3d at_m = mesh.position_m.row(0).transpose();
  return [at_m, finest_m](const Eigen::Vector3d& p) {
    return finest_m + 0.5 * (p - at_m).norm();
  };
}

void for_every_edge(const SurfaceMesh& mesh, const auto& check) {
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      const Eigen::Vector3d a = mesh.position_m.row(mesh.triangle(t, j)).transpose();
      const Eigen::Vector3d b =
          mesh.position_m.row(mesh.triangle(t, (j + 1) % 3)).transpose();
      check(a, b);
    }
  }
}

TEST(LongestEdge, LeavesNoEdgeLongerThanAsked) {
  const SurfaceMesh mesh = organ(2);
  for (const EdgeLength& wanted : {uniform(0.005), graded(mesh, 0.001)}) {
    const SurfaceMesh fine = refine_longest_edge(mesh, wanted, kMany);
    EXPECT_GT(fine.triangle.rows(), mesh.triangle.rows() + 100);
    for_every_edge(fine, [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
      EXPECT_LE((b - a).norm(), wanted(0.5 * (a + b)) * (1.0 + 1e-12));
    });
  }
}

TEST(LongestEdge, KeepsOldVerticesAndPutsNewOnesOnOldEdges) {
  const SurfaceMesh mesh = icosphere(0.01, 1);
  const SurfaceMesh fine = refine_longest_edge(mesh, graded(mesh, 0.002), kMany);
  EXPECT_EQ(fine.position_m.topRows(mesh.position_m.rows()), mesh.position_m);
  // The same point set: no area, no volume gained or lost.
  EXPECT_NEAR(surface_area_m2(fine) / surface_area_m2(mesh), 1.0, 1e-12);
  EXPECT_NEAR(enclosed_volume_m3(fine) / enclosed_volume_m3(mesh), 1.0, 1e-12);
}

TEST(LongestEdge, KeepsAClosedManifoldClosed) {
  for (const SurfaceMesh& mesh : {organ(2), cylinder(0.01, 0.03, 3)}) {
    const SurfaceReport report =
        check_surface(refine_longest_edge(mesh, graded(mesh, 0.0008), kMany)).report;
    EXPECT_TRUE(report.accepted()) << report.verdict();
    EXPECT_EQ(report.components, 1);
  }
}

TEST(LongestEdge, KeepsHalfOfTheSmallestAngle) {
  for (const SurfaceMesh& mesh :
       {organ(2), cylinder(0.01, 0.2, 2), icosphere(1.0, 0)}) {
    const double before = check_surface(mesh).report.smallest_angle_rad;
    const double finest_m = 0.05 * mean_edge_m(mesh);
    const SurfaceMesh fine = refine_longest_edge(mesh, graded(mesh, finest_m), kMany);
    // Rivara's bound; 1e-9: rounding.
    EXPECT_GE(check_surface(fine).report.smallest_angle_rad, 0.5 * before - 1e-9);
  }
}

TEST(LongestEdge, LeavesAFineSurfaceAlone) {
  const SurfaceMesh mesh = organ(2);
  const SurfaceMesh same = refine_longest_edge(mesh, uniform(1.0), kMany);
  EXPECT_EQ(same.position_m, mesh.position_m);
  EXPECT_EQ(same.triangle, mesh.triangle);
}

TEST(LongestEdge, EndsBeyondTheLargestNumberOfTriangles) {
  const SurfaceMesh mesh = organ(2);
  const SurfaceMesh fine = refine_longest_edge(mesh, uniform(1e-5), 2000);
  EXPECT_GT(fine.triangle.rows(), 2000);
  // A pass makes at most four of each.
  EXPECT_LE(fine.triangle.rows(), 8000);
  EXPECT_TRUE(check_surface(fine).report.accepted());
  EXPECT_EQ(refine_longest_edge(mesh, uniform(1e-5), 10).triangle, mesh.triangle);
}

TEST(LongestEdge, GivesTheSameForTheSame) {
  const SurfaceMesh mesh = icosphere(1.0, 1);  // many edges of equal length
  const SurfaceMesh a = refine_longest_edge(mesh, graded(mesh, 0.05), kMany);
  const SurfaceMesh b = refine_longest_edge(mesh, graded(mesh, 0.05), kMany);
  EXPECT_EQ(a.position_m, b.position_m);
  EXPECT_EQ(a.triangle, b.triangle);
}

TEST(LongestEdge, RefusesLengthsThatAreNotPositive) {
  const SurfaceMesh mesh = icosphere(1.0, 1);
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW((void)refine_longest_edge(mesh, uniform(bad), kMany), InputError);
  }
}

}  // namespace
}  // namespace palpate
