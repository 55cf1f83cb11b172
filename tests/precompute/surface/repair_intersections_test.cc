#include "precompute/surface/repair_intersections.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "formats/base/at.h"
#include "precompute/surface/primitive_bodies.h"
#include "precompute/surface/repair.h"
#include "precompute/surface/self_intersections.h"
#include "precompute/surface/surface_check.h"
#include "tests/support/study_bodies.h"

namespace palpate {
namespace {

constexpr double kRadius = 0.05;

SurfaceMesh ball() {
  return icosphere(kRadius, 4);
}

// A vertex is pushed in by a share of an edge's length, and those around it change
// sides above it: its triangles run through one another.
SurfaceMesh with_knot(SurfaceMesh mesh, std::int32_t vertex, double share) {
  const double depth_m = share * mean_edge_m(mesh);
  const Eigen::RowVector3d top = mesh.position_m.row(vertex);
  const auto around = vertex_neighbours(mesh.position_m.rows(), mesh.triangle);
  for (const std::int32_t v : around[at(vertex)]) {
    mesh.position_m.row(v) = (1.3 * top - 0.3 * mesh.position_m.row(v)).eval();
  }
  mesh.position_m.row(vertex) = top * (1.0 - depth_m / kRadius);
  return mesh;
}

// A cap of a vertex and the five around it, raised on a stalk of ten that is twisted by
// half a turn: only the stalk crosses itself.
SurfaceMesh with_twisted_stalk(SurfaceMesh mesh, std::int32_t vertex) {
  const auto around = vertex_neighbours(mesh.position_m.rows(), mesh.triangle);
  const Eigen::RowVector3d top = mesh.position_m.row(vertex);
  std::set<std::int32_t> cap{vertex};
  cap.insert(around[at(vertex)].begin(), around[at(vertex)].end());
  std::set<std::int32_t> stalk;
  for (const std::int32_t v : cap) {
    stalk.insert(around[at(v)].begin(), around[at(v)].end());
  }
  for (const std::int32_t v : stalk) {
    if (!cap.contains(v)) {
      mesh.position_m.row(v) = (1.3 * top - 0.3 * mesh.position_m.row(v)).eval();
    }
  }
  for (const std::int32_t v : cap) {
    mesh.position_m.row(v) += 2.0 * mean_edge_m(ball()) / kRadius * top;
  }
  return mesh;
}

// Each coordinate moves by up to a share of an edge's length.
SurfaceMesh roughened(SurfaceMesh mesh, double share, std::uint32_t seed) {
  const double most_m = share * mean_edge_m(mesh);
  std::mt19937 random(seed);
  for (double& x : mesh.position_m.reshaped()) {
    x += most_m * (2.0 * static_cast<double>(random()) / 4294967295.0 - 1.0);
  }
  return mesh;
}

// Two balls that share space, as one part: a tube joins a triangle of each on top.
SurfaceMesh two_joined_balls(double distance_m) {
  const SurfaceMesh one = ball();
  const auto shift = static_cast<std::int32_t>(one.position_m.rows());
  const Eigen::Index n = one.triangle.rows();
  Eigen::Index top = 0;
  double highest_m = 0.0;
  for (Eigen::Index t = 0; t < n; ++t) {
    const double z = one.position_m(one.triangle.row(t), 2).minCoeff();
    if (z > highest_m) {
      highest_m = z;
      top = t;
    }
  }
  SurfaceMesh both;
  both.position_m.resize(2 * shift, 3);
  both.position_m << one.position_m, one.position_m;
  both.position_m.bottomRows(shift).col(0) *= -1.0;
  both.position_m.bottomRows(shift).col(0).array() += distance_m;
  both.triangle.resize(2 * n, 3);
  both.triangle << one.triangle,
      (one.triangle.array() + shift).matrix().rowwise().reverse();
  const Eigen::RowVector3i a = one.triangle.row(top);
  both.triangle.conservativeResize(2 * n + 4, 3);
  const auto side = [&](Eigen::Index row, std::int32_t p, std::int32_t q) {
    both.triangle.row(row) << p, q, p + shift;
    return Eigen::RowVector3i(q, q + shift, p + shift);
  };
  both.triangle.row(2 * n) = side(top, a[0], a[1]);
  both.triangle.row(2 * n + 1) = side(top + n, a[1], a[2]);
  both.triangle.row(2 * n + 3) = side(2 * n + 2, a[2], a[0]);
  return both;
}

TEST(RepairIntersections, LeavesABodyAlone) {
  const SurfaceMesh mesh = organ(2);
  const SurfaceMesh result = repair_intersections(mesh);
  EXPECT_EQ(result.position_m, mesh.position_m);
  EXPECT_EQ(result.triangle, mesh.triangle);
}

TEST(RepairIntersections, CutsOutAKnotAndNoMore) {
  const SurfaceMesh mesh = with_knot(ball(), 7, 0.5);  // five triangles meet in it
  ASSERT_GT(self_intersections(mesh).size(), 50U);
  const SurfaceMesh result = repair_intersections(mesh);
  const SurfaceReport report = check_surface(result).report;
  EXPECT_TRUE(report.accepted()) << report.verdict();
  EXPECT_EQ(report.components, 1);
  // The vertex and the five around it.
  EXPECT_EQ(report.vertices, mesh.position_m.rows() - 6);
  // A flat lid over two edges' length takes a cap of height h off: pi h^2 (R - h / 3).
  const double h =
      1.0 - std::sqrt(1.0 - std::pow(2.0 * mean_edge_m(mesh) / kRadius, 2));
  const double ball_m3 = enclosed_volume_m3(ball());
  EXPECT_NEAR(report.volume_m3 / ball_m3, 1.0, 0.75 * h * h * (1.0 - h / 3.0));
}

TEST(RepairIntersections, DropsWhatACutPartsFromTheRest) {
  const SurfaceMesh mesh = with_twisted_stalk(ball(), 7);
  ASSERT_GT(self_intersections(mesh).size(), 20U);
  const SurfaceReport report = check_surface(repair_intersections(mesh)).report;
  EXPECT_TRUE(report.accepted()) << report.verdict();
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(report.vertices, mesh.position_m.rows() - 16);  // the cap and the stalk
}

TEST(RepairIntersections, MakesABodyThatIsAccepted) {
  const SurfaceMesh mesh = with_knot(with_knot(ball(), 7, 0.5), 500, 0.4);
  const RepairedSurface repaired = repair_surface(mesh, RepairMode::kSafe);
  EXPECT_EQ(repaired.report.refusal, "");
  EXPECT_EQ(repaired.report.after.self_intersections.count, 0U);
  EXPECT_LT(std::abs(repaired.report.volume_relative), 1e-3);
  for (std::size_t v = 0; v < repaired.report.original_vertex.size(); ++v) {
    ASSERT_GE(repaired.report.original_vertex[v], 0) << "vertex " << v << " is new";
  }
  ASSERT_EQ(repaired.report.changed.size(), 1U);
  EXPECT_EQ(repaired.report.changed[0].count,
            repaired.report.before.self_intersections.count);
}

TEST(RepairIntersections, LeavesNoCrossingOnARoughBall) {
  const SurfaceMesh mesh = roughened(ball(), 0.7, 1);
  ASSERT_GT(self_intersections(mesh).size(), 20U);
  const SurfaceReport report = check_surface(repair_intersections(mesh)).report;
  EXPECT_TRUE(report.accepted()) << report.verdict();
  EXPECT_EQ(report.components, 1);
  EXPECT_GT(report.vertices, mesh.position_m.rows() * 9 / 10);
  EXPECT_NEAR(report.volume_m3 / enclosed_volume_m3(ball()), 1.0, 0.02);
}

// Crossing triangles are nearly everywhere, and the last ones need a ring around them.
// Little of the ball is left: a body, but another one.
TEST(RepairIntersections, RefusesWhatIsLeftOfARuin) {
  const SurfaceMesh mesh = roughened(icosphere(kRadius, 2), 1.1, 11);
  ASSERT_GT(self_intersections(mesh).size(), 200U);
  const SurfaceReport report = check_surface(repair_intersections(mesh)).report;
  EXPECT_TRUE(report.accepted()) << report.verdict();
  EXPECT_EQ(report.components, 1);
  EXPECT_NE(repair_surface(mesh, RepairMode::kSafe).report.refusal, "");
}

TEST(RepairIntersections, NeverLosesABallUnnoticed) {
  const SurfaceMesh mesh = two_joined_balls(1.7 * kRadius);
  ASSERT_EQ(check_surface(mesh).report.components, 1);
  ASSERT_EQ(check_surface(mesh).report.border_edges.count, 0U);
  ASSERT_GT(self_intersections(mesh).size(), 100U);
  const RepairedSurface repaired = repair_surface(mesh, RepairMode::kSafe);
  EXPECT_NE(repaired.report.refusal, "");
}

SurfaceMesh tetrahedron(double size_m) {
  SurfaceMesh mesh;
  mesh.position_m.resize(4, 3);
  mesh.position_m << 1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1;
  mesh.position_m *= size_m;
  mesh.triangle.resize(4, 3);
  mesh.triangle << 0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2;
  return mesh;
}

// All four faces of a tetrahedron cross the other surface: nothing of it would be left.
TEST(RepairIntersections, TakesNoPartAway) {
  SurfaceMesh small = tetrahedron(0.2 * kRadius);
  small.position_m.col(0).array() += kRadius;
  SurfaceMesh turned = tetrahedron(kRadius);
  turned.position_m *= -1.0;
  turned.triangle.col(1).swap(turned.triangle.col(2));
  for (const SurfaceMesh& mesh :
       {joined(ball(), small), joined(tetrahedron(kRadius), turned)}) {
    ASSERT_GT(self_intersections(mesh).size(), 3U);
    const SurfaceMesh result = repair_intersections(mesh);
    EXPECT_EQ(check_surface(result).report.components, 2);
    EXPECT_EQ(result.triangle, mesh.triangle);
  }
}

// Each of two parts gives up the cap that lies in the other: a body, but another one.
TEST(RepairIntersections, RefusesPartsThatOverlapDeeply) {
  SurfaceMesh other = ball();
  other.position_m.rowwise() += Eigen::RowVector3d(0.06, 0.005, 0.0025);
  const SurfaceMesh both = joined(ball(), other);
  const SurfaceReport report = check_surface(repair_intersections(both)).report;
  EXPECT_EQ(report.components, 2);
  EXPECT_TRUE(report.closed());
  EXPECT_NE(repair_surface(both, RepairMode::kSafe).report.refusal, "");
}

}  // namespace
}  // namespace palpate
