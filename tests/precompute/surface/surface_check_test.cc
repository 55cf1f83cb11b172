#include "precompute/surface/surface_check.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/mesh/surface_reader.h"
#include "precompute/surface/primitive_bodies.h"
#include "tests/support/study_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

SurfaceMesh moved(SurfaceMesh mesh, const Eigen::RowVector3d& by_m) {
  mesh.position_m.rowwise() += by_m;
  return mesh;
}

SurfaceMesh inside_out(SurfaceMesh mesh) {
  mesh.triangle.col(1).swap(mesh.triangle.col(2));
  return mesh;
}

SurfaceMesh without_last_triangle(SurfaceMesh mesh) {
  mesh.triangle.conservativeResize(mesh.triangle.rows() - 1, 3);
  return mesh;
}

SurfaceReport report_of(const SurfaceMesh& mesh) {
  return check_surface(mesh).report;
}

// Defects of all kinds together, to show that a surface has one kind only.
std::size_t all_defects(const SurfaceReport& report) {
  std::size_t sum = 0;
  for (const DefectKind& kind : defect_kinds()) {
    sum += (report.*kind.defect).count;
  }
  return sum;
}

TEST(SurfaceCheck, AcceptsGeneratedBodiesAndLeavesThemAlone) {
  for (const SurfaceMesh& mesh : {icosphere(0.01, 3), organ(), cylinder(0.01, 0.02, 4),
                                  graded_block(0.1, 0.05, 0.004, 8)}) {
    const CheckedSurface checked = check_surface(mesh);
    EXPECT_TRUE(checked.report.accepted()) << checked.report.verdict();
    EXPECT_EQ(checked.report.components, 1);
    EXPECT_EQ(checked.report.components_turned, 0);
    EXPECT_EQ(checked.mesh.position_m, mesh.position_m);
    EXPECT_EQ(checked.mesh.triangle, mesh.triangle);
  }
}

TEST(SurfaceCheck, MeasuresTheBody) {
  const SurfaceReport report = report_of(graded_block(0.1, 0.05, 0.004, 8));
  EXPECT_NEAR(report.volume_m3, 0.002, 1e-15);
  EXPECT_NEAR(report.area_m2, 0.12, 1e-14);
  EXPECT_EQ(report.extent_m, Eigen::Vector3d(0.2, 0.2, 0.05));
  EXPECT_EQ(report.lowest_m, Eigen::Vector3d(-0.1, -0.1, -0.05));
  const SurfaceReport ico = report_of(icosphere(1.0, 0));
  EXPECT_NEAR(ico.smallest_angle_rad, std::numbers::pi / 3, 1e-14);
}

TEST(SurfaceCheck, CountsTheBorderOfAHole) {
  const SurfaceMesh mesh = without_last_triangle(icosphere(0.01, 2));
  const SurfaceReport report = report_of(mesh);
  EXPECT_FALSE(report.accepted());
  EXPECT_FALSE(report.closed());
  EXPECT_EQ(report.border_edges.count, 3U);
  EXPECT_EQ(report.border_edges.where_m.size(), 3U);
  EXPECT_EQ(all_defects(report), 3U);
  EXPECT_NE(report.verdict().find("3 border edges (the surface is open) at ("),
            std::string::npos);
}

TEST(SurfaceCheck, FindsTheTriangleThatFacesTheOtherWay) {
  SurfaceMesh mesh = icosphere(0.01, 2);
  std::swap(mesh.triangle(17, 0), mesh.triangle(17, 1));
  const SurfaceReport report = report_of(mesh);
  EXPECT_FALSE(report.accepted());
  EXPECT_EQ(report.flipped_edges.count, 3U);
  EXPECT_EQ(all_defects(report), 3U);
  // The edge's middle is a place on the triangle.
  const Eigen::Vector3d a = mesh.position_m.row(mesh.triangle(17, 0)).transpose();
  EXPECT_LT((report.flipped_edges.where_m[0] - a).norm(), 0.006);
}

TEST(SurfaceCheck, TurnsAnInsideOutBodyAndSaysSo) {
  const SurfaceMesh right = organ();
  const CheckedSurface checked = check_surface(inside_out(right));
  EXPECT_TRUE(checked.report.accepted());
  EXPECT_EQ(checked.report.components_turned, 1);
  EXPECT_EQ(checked.mesh.triangle, right.triangle);
  EXPECT_GT(checked.report.volume_m3, 0.0);
  EXPECT_NE(checked.report.verdict().find("inside out, turned"), std::string::npos);
}

TEST(SurfaceCheck, CountsSelfIntersectionsOfCrossingParts) {
  const SurfaceMesh one = icosphere(0.01, 1);
  const SurfaceMesh mesh = joined(one, moved(one, {0.012, 0.001, 0.0005}));
  const SurfaceReport report = report_of(mesh);
  EXPECT_FALSE(report.accepted());
  EXPECT_EQ(report.components, 2);
  EXPECT_GT(report.self_intersections.count, 5U);
  EXPECT_EQ(all_defects(report), report.self_intersections.count);
  // They cross halfway between the centres.
  EXPECT_NEAR(report.self_intersections.where_m[0].x(), 0.006, 0.004);
}

TEST(SurfaceCheck, TellsFoldedFromFlatNeighbours) {
  // Two triangles at an edge in one plane: side by side, and one over the other.
  SurfaceMesh mesh;
  mesh.position_m.resize(4, 3);
  mesh.position_m << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0.3, -1, 0;
  mesh.triangle.resize(2, 3);
  mesh.triangle << 0, 1, 2, 1, 0, 3;
  EXPECT_EQ(report_of(mesh).self_intersections.count, 0U);
  mesh.position_m(3, 1) = 0.2;
  EXPECT_EQ(report_of(mesh).self_intersections.count, 1U);
}

TEST(SurfaceCheck, FindsAVertexPushedThroughTheBody) {
  SurfaceMesh mesh = icosphere(0.01, 2);
  mesh.position_m.row(0) *= -1.2;
  const SurfaceReport report = report_of(mesh);
  EXPECT_FALSE(report.accepted());
  EXPECT_GT(report.self_intersections.count, 0U);
}

TEST(SurfaceCheck, FindsTrianglesWithoutArea) {
  SurfaceMesh mesh = icosphere(0.01, 1);
  // A corner moved onto the middle of the opposite edge of triangle 0.
  mesh.position_m.row(mesh.triangle(0, 0)) =
      0.5 * (mesh.position_m.row(mesh.triangle(0, 1)) +
             mesh.position_m.row(mesh.triangle(0, 2)));
  const SurfaceReport report = report_of(mesh);
  EXPECT_FALSE(report.accepted());
  EXPECT_EQ(report.degenerate_triangles.count, 1U);
  EXPECT_LT(report.smallest_angle_rad, 1e-9);
}

TEST(SurfaceCheck, RefusesPartsThatTouchInAVertex) {
  // Two tetrahedra with one vertex in common.
  SurfaceMesh mesh;
  mesh.position_m.resize(7, 3);
  mesh.position_m << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, -1, 0, 0, 0, -1, 0, 0, 0, -1;
  mesh.triangle.resize(8, 3);
  mesh.triangle << 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3,  //
      0, 4, 5, 0, 6, 4, 0, 5, 6, 4, 6, 5;
  const SurfaceReport report = report_of(mesh);
  EXPECT_FALSE(report.accepted());
  EXPECT_EQ(report.non_manifold_vertices.count, 1U);
  EXPECT_EQ(report.non_manifold_vertices.where_m[0], Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(all_defects(report), 1U);
}

TEST(SurfaceCheck, RefusesPartsThatTouchWithoutACommonVertex) {
  const SurfaceMesh one = cylinder(1.0, 1.0, 2);
  const SurfaceReport report = report_of(joined(one, moved(one, {0.0, 0.0, 1.0})));
  EXPECT_FALSE(report.accepted());
  EXPECT_EQ(report.duplicate_vertices.count, 19U);  // a disk of two rings
  EXPECT_GT(report.self_intersections.count, 0U);
}

TEST(SurfaceCheck, FindsEdgesOfMoreThanTwoTriangles) {
  SurfaceMesh mesh = icosphere(0.01, 1);
  const SurfaceMesh fin = mesh;
  mesh.position_m.conservativeResize(mesh.position_m.rows() + 1, 3);
  mesh.position_m.bottomRows(1) << 0.03, 0.03, 0.03;
  mesh.triangle.conservativeResize(mesh.triangle.rows() + 1, 3);
  mesh.triangle.bottomRows(1) << fin.triangle(0, 0), fin.triangle(0, 1),
      static_cast<int>(fin.position_m.rows());
  const SurfaceReport report = report_of(mesh);
  EXPECT_EQ(report.non_manifold_edges.count, 1U);
  EXPECT_EQ(report.border_edges.count, 2U);
}

TEST(SurfaceCheck, FindsVerticesOfNoTriangle) {
  SurfaceMesh mesh = icosphere(0.01, 1);
  mesh.position_m.conservativeResize(mesh.position_m.rows() + 1, 3);
  mesh.position_m.bottomRows(1) << 0.03, 0.02, 0.01;
  const SurfaceReport report = report_of(mesh);
  EXPECT_EQ(report.isolated_vertices.count, 1U);
  EXPECT_EQ(report.verdict(),
            "not a body: 1 vertex of no triangle at (0.03, 0.02, 0.01) m");
}

TEST(SurfaceCheck, AcceptsDisjointPartsAndSaysSo) {
  const SurfaceMesh one = icosphere(0.01, 1);
  const CheckedSurface checked =
      check_surface(joined(one, inside_out(moved(one, {0.05, 0.0, 0.0}))));
  EXPECT_TRUE(checked.report.accepted());
  EXPECT_EQ(checked.report.components_turned, 1);
  EXPECT_NEAR(checked.report.volume_m3, 2 * enclosed_volume_m3(one), 1e-18);
  EXPECT_NE(checked.report.verdict().find("in 2 disjoint parts"), std::string::npos);
}

TEST(SurfaceCheck, RefusesAPartInsideAnotherThatFacesAsItDoes) {
  const SurfaceMesh outer = icosphere(0.01, 1);
  const SurfaceMesh both = joined(outer, icosphere(0.004, 1));
  for (const SurfaceMesh& mesh : {both, inside_out(both)}) {
    const SurfaceReport report = report_of(mesh);
    EXPECT_FALSE(report.accepted());
    EXPECT_EQ(report.nested_components.count, 1U);
    EXPECT_EQ(all_defects(report), 1U);
    EXPECT_NE(report.verdict().find("[[inclusion]]"), std::string::npos);
  }
}

TEST(SurfaceCheck, TakesAPartInsideThatFacesTheOtherWayForACavity) {
  const SurfaceMesh outer = icosphere(0.01, 1);
  const SurfaceMesh inner = icosphere(0.004, 1);
  const SurfaceMesh right = joined(outer, inside_out(inner));
  for (const bool turned : {false, true}) {
    const CheckedSurface checked = check_surface(turned ? inside_out(right) : right);
    EXPECT_TRUE(checked.report.accepted()) << checked.report.verdict();
    EXPECT_EQ(checked.mesh.triangle, right.triangle);
    EXPECT_EQ(checked.report.components_turned, turned ? 2 : 0);
    EXPECT_EQ(checked.report.cavities(), 1);
    EXPECT_NEAR(checked.report.volume_m3,
                enclosed_volume_m3(outer) - enclosed_volume_m3(inner), 1e-20);
    EXPECT_NE(checked.report.verdict().find("triangles, with 1 cavity"),
              std::string::npos)
        << checked.report.verdict();
  }
}

TEST(SurfaceCheck, TellsCavitiesFromIslandsInThem) {
  // Two cavities, in one of them a ball; first of all that ball, then a cavity.
  const SurfaceMesh island = moved(icosphere(0.001, 1), {0.004, 0.0, 0.0});
  const SurfaceMesh one = inside_out(moved(icosphere(0.003, 1), {0.004, 0.0, 0.0}));
  const SurfaceMesh two = inside_out(moved(icosphere(0.003, 1), {-0.004, 0.0, 0.0}));
  const SurfaceMesh mesh = joined(joined(island, one), joined(icosphere(0.01, 2), two));
  const CheckedSurface checked = check_surface(mesh);
  EXPECT_TRUE(checked.report.accepted()) << checked.report.verdict();
  EXPECT_EQ(checked.mesh.triangle, mesh.triangle);
  ASSERT_EQ(checked.report.part.size(), 4U);
  EXPECT_EQ(checked.report.part[0].around, 2);
  EXPECT_EQ(checked.report.part[1].around, 1);
  EXPECT_EQ(checked.report.part[2].around, 0);
  EXPECT_EQ(checked.report.part[3].around, 1);
  EXPECT_NE(checked.report.verdict().find("in 2 disjoint parts, with 2 cavities"),
            std::string::npos)
      << checked.report.verdict();
}

TEST(SurfaceCheck, TellsWhichOfManyPartsLieInside) {
  for (const bool turned : {false, true}) {
    SurfaceMesh mesh = turned ? inside_out(icosphere(1.0, 2)) : icosphere(1.0, 2);
    const SurfaceMesh bubble =
        turned ? icosphere(0.01, 0) : inside_out(icosphere(0.01, 0));
    for (int i = 0; i < 20; ++i) {
      // Within the bounding box, inside and outside by turns.
      const double far_m = i % 2 == 0 ? 0.9 : 1.1;
      mesh =
          joined(mesh, moved(bubble, far_m * Eigen::RowVector3d(std::cos(0.3 * i),
                                                                std::sin(0.3 * i), 0.5)
                                                 .normalized()));
    }
    const CheckedSurface checked = check_surface(mesh);
    EXPECT_TRUE(checked.report.accepted()) << checked.report.verdict();
    ASSERT_EQ(checked.report.part.size(), 21U);
    for (std::size_t i = 0; i < 20; ++i) {
      EXPECT_EQ(checked.report.part[i + 1].around, i % 2 == 0 ? 1 : 0) << i;
    }
  }
}

TEST(SurfaceCheck, DoesNotTakeAPartInTheBoundingBoxForNested) {
  // Beyond the middle of a triangle of the coarse sphere, within its bounding box.
  const SurfaceMesh outer = icosphere(1.0, 1);
  const SurfaceReport report =
      report_of(joined(outer, moved(icosphere(0.05, 1), {0.75, 0.75, 0.75})));
  EXPECT_TRUE(report.accepted()) << report.verdict();
  EXPECT_EQ(report.components, 2);
}

TEST(SurfaceCheck, RefusesABodyWithoutVolumeAndNoBodyAtAll) {
  SurfaceMesh sheet;
  sheet.position_m.resize(3, 3);
  sheet.position_m << 0, 0, 0, 1, 0, 0, 0, 1, 0;
  sheet.triangle.resize(2, 3);
  sheet.triangle << 0, 1, 2, 0, 2, 1;
  EXPECT_FALSE(report_of(sheet).accepted());
  EXPECT_NE(report_of(sheet).verdict().find("encloses no volume"), std::string::npos);
  EXPECT_FALSE(report_of(SurfaceMesh{}).accepted());
}

TEST(RequireBody, NamesTheFileAndTheDefect) {
  try {
    (void)require_body(without_last_triangle(icosphere(0.01, 1)), "liver.obj");
    FAIL() << "accepted an open surface";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).rfind("liver.obj: not a body: 3 border", 0), 0U)
        << error.what();
  }
}

TEST(SurfaceCheck, AcceptsRealCleanBodies) {
  for (const auto& [name, vertices] :
       {std::pair{"meshes/sofa_liver2.obj", 1170}, {"meshes/c3d_spot.obj", 2930}}) {
    const auto file = test_data(name);
    if (!file) {
      GTEST_SKIP() << "no test data";
    }
    const CheckedSurface checked = check_surface(read_surface(*file, "cm"));
    EXPECT_TRUE(checked.report.accepted()) << name << checked.report.verdict();
    EXPECT_EQ(checked.report.vertices, vertices);
    EXPECT_EQ(checked.report.components, 1);
  }
}

TEST(SurfaceCheck, NamesTheSevenSelfIntersectionsOfARealLiver) {
  const auto file = test_data("meshes/sofa_liver-smooth.obj");
  if (!file) {
    GTEST_SKIP() << "no test data";
  }
  const SurfaceReport report = report_of(read_surface(*file, "cm"));
  EXPECT_FALSE(report.accepted());
  EXPECT_EQ(report.self_intersections.count, 7U);
  EXPECT_NE(report.verdict().find("7 self-intersecting pairs of triangles at ("),
            std::string::npos);
}

}  // namespace
}  // namespace palpate
