// Surfaces as segmentations, games and CAD leave them.
#include <cmath>

#include <gtest/gtest.h>

#include "precompute/surface/primitive_bodies.h"
#include "precompute/surface/repair.h"
#include "precompute/surface/surface_check.h"
#include "tests/support/study_bodies.h"

namespace palpate {
namespace {

SurfaceMesh shifted(SurfaceMesh mesh, const Eigen::RowVector3d& by_m) {
  mesh.position_m.rowwise() += by_m;
  return mesh;
}

SurfaceMesh whole_ball() {
  return icosphere(0.03, 3);
}

SurfaceMesh speck(double x_m) {
  return shifted(icosphere(2e-5, 0), {x_m, 0.0, 0.0});
}

// Every triangle a second time, the other way round.
SurfaceMesh double_sided(SurfaceMesh mesh) {
  const Triangles back = mesh.triangle.rowwise().reverse();
  mesh.triangle.conservativeResize(2 * mesh.triangle.rows(), 3);
  mesh.triangle.bottomRows(back.rows()) = back;
  return mesh;
}

// A triangle list far from the origin in single precision, with corners that differ by
// one step of it.
SurfaceMesh cracked(const SurfaceMesh& mesh) {
  SurfaceMesh soup;
  soup.position_m.resize(3 * mesh.triangle.rows(), 3);
  soup.triangle.resize(mesh.triangle.rows(), 3);
  for (std::int32_t t = 0; t < mesh.triangle.rows(); ++t) {
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector3f p = (mesh.position_m.row(mesh.triangle(t, j)).transpose() +
                                 Eigen::Vector3d(0.0, 0.0, 1.0))
                                    .cast<float>();
      soup.triangle(t, j) = 3 * t + j;
      soup.position_m.row(3 * t + j) = p.cast<double>().transpose();
      if ((t + j) % 3 == 0) {
        soup.position_m(3 * t + j, 2) =
            static_cast<double>(std::nextafter(p.z(), 2.0F));
      }
    }
  }
  return soup;
}

TEST(StrangerSurfaces, SpecksAreNamedAndSafeRepairLeavesThemOut) {
  for (const double at_m : {0.05, 0.0}) {  // beside the body, and inside
    const SurfaceMesh mesh = joined(whole_ball(), speck(at_m));
    const SurfaceReport report = check_surface(mesh).report;
    EXPECT_EQ(report.specks(), 1);
    ASSERT_EQ(report.part.size(), 2U);
    EXPECT_TRUE(report.part[1].speck);
    EXPECT_NEAR(report.part[1].middle_m.x(), at_m, 1e-5);
    const RepairedSurface repaired = repair_surface(mesh, RepairMode::kSafe);
    EXPECT_EQ(repaired.report.refusal, "");
    EXPECT_EQ(repaired.mesh.position_m, whole_ball().position_m);
    EXPECT_EQ(repaired.mesh.triangle, whole_ball().triangle);
    ASSERT_EQ(repaired.report.changed.size(), 1U);
    EXPECT_NE(repaired.report.changed[0].what.find("specks"), std::string::npos);
  }
}

TEST(StrangerSurfaces, AStrayTriangleIsASpeck) {
  SurfaceMesh mesh = joined(whole_ball(), speck(0.05));
  mesh.triangle.conservativeResize(whole_ball().triangle.rows() + 1, 3);
  const RepairedSurface repaired = repair_surface(mesh, RepairMode::kSafe);
  EXPECT_EQ(repaired.report.refusal, "");
  EXPECT_EQ(repaired.mesh.triangle, whole_ball().triangle);
}

TEST(StrangerSurfaces, APartOfSomeSizeIsNone) {
  const SurfaceMesh mesh =
      joined(whole_ball(), shifted(icosphere(0.004, 2), {0.05, 0.0, 0.0}));
  const SurfaceReport report = check_surface(mesh).report;
  EXPECT_EQ(report.specks(), 0);
  EXPECT_EQ(repair_surface(mesh, RepairMode::kSafe).mesh.triangle, mesh.triangle);
}

TEST(StrangerSurfaces, AnInnerWallThatFacesOutIsTurnedAndSaid) {
  const SurfaceMesh inner = icosphere(0.02, 2);
  const SurfaceMesh mesh = joined(whole_ball(), inner);
  const RepairedSurface repaired = repair_surface(mesh, RepairMode::kSafe);
  EXPECT_EQ(repaired.report.refusal, "");
  EXPECT_EQ(repaired.report.after.cavities(), 1);
  EXPECT_EQ(repaired.mesh.position_m, mesh.position_m);
  EXPECT_NEAR(enclosed_volume_m3(repaired.mesh),
              enclosed_volume_m3(whole_ball()) - enclosed_volume_m3(inner), 1e-15);
  ASSERT_EQ(repaired.report.changed.size(), 1U);
  EXPECT_EQ(repaired.report.changed[0].count, 1U);
  EXPECT_NE(repaired.report.changed[0].what.find("is a cavity"), std::string::npos);
  EXPECT_EQ(working_repair(mesh, RepairMode::kOff), RepairMode::kSafe);
}

TEST(StrangerSurfaces, PiecesThatMakeUpTheBodyAreNoSpecks) {
  EXPECT_EQ(check_surface(cracked(whole_ball())).report.specks(), 0);
}

TEST(StrangerSurfaces, OneOfTwoFacesIsKept) {
  const RepairedSurface repaired =
      repair_surface(double_sided(whole_ball()), RepairMode::kSafe);
  EXPECT_EQ(repaired.report.refusal, "");
  EXPECT_EQ(repaired.mesh.triangle.rows(), whole_ball().triangle.rows());
  EXPECT_NEAR(enclosed_volume_m3(repaired.mesh) / enclosed_volume_m3(whole_ball()), 1.0,
              1e-12);
}

TEST(StrangerSurfaces, CracksOfTheLastBitAreWelded) {
  const RepairedSurface repaired =
      repair_surface(cracked(whole_ball()), RepairMode::kSafe);
  EXPECT_EQ(repaired.report.refusal, "");
  EXPECT_EQ(repaired.mesh.position_m.rows(), whole_ball().position_m.rows());
  EXPECT_EQ(repaired.mesh.triangle.rows(), whole_ball().triangle.rows());
  EXPECT_LT(repaired.report.displaced_m, 5e-7);  // four steps of 1.2e-7 at 1 m
}

TEST(StrangerSurfaces, AVertexOnANeighboursEdgeIsPutThere) {
  SurfaceMesh mesh = whole_ball();
  const Eigen::RowVector3i first = mesh.triangle.row(0);
  const auto middle = static_cast<std::int32_t>(mesh.position_m.rows());
  mesh.position_m.conservativeResize(middle + 1, 3);
  mesh.position_m.row(middle) =
      0.5 * (mesh.position_m.row(first[0]) + mesh.position_m.row(first[1]));
  mesh.triangle.conservativeResize(mesh.triangle.rows() + 1, 3);
  mesh.triangle.row(0) << first[0], middle, first[2];
  mesh.triangle.bottomRows(1) << middle, first[1], first[2];
  const RepairedSurface repaired = repair_surface(mesh, RepairMode::kSafe);
  EXPECT_EQ(repaired.report.refusal, "");
  EXPECT_EQ(repaired.mesh.position_m, mesh.position_m);
  EXPECT_EQ(repaired.mesh.triangle.rows(), mesh.triangle.rows() + 1);
  EXPECT_NEAR(enclosed_volume_m3(repaired.mesh) / enclosed_volume_m3(whole_ball()), 1.0,
              1e-12);
}

TEST(StrangerSurfaces, ASheetIsRefusedWithWhatWouldBeRight) {
  SurfaceMesh sheet;
  sheet.position_m.resize(4, 3);
  sheet.position_m << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
  sheet.triangle.resize(2, 3);
  sheet.triangle << 0, 1, 2, 0, 2, 3;
  for (const RepairMode mode :
       {RepairMode::kOff, RepairMode::kSafe, RepairMode::kWrap}) {
    const std::string refusal = repair_surface(sheet, mode).report.refusal;
    EXPECT_NE(refusal.find("thickness"), std::string::npos) << refusal;
  }
  EXPECT_EQ(working_repair(sheet, RepairMode::kOff), RepairMode::kOff);
}

}  // namespace
}  // namespace palpate
