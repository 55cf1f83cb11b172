#include "precompute/surface/repair.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/mesh/surface_reader.h"
#include "precompute/surface/primitive_bodies.h"
#include "precompute/surface/surface_soup.h"
#include "precompute/surface/winding_number.h"
#include "tests/support/study_bodies.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

// Every triangle with corners of its own, as some files list them.
SurfaceMesh exploded(const SurfaceMesh& mesh) {
  SurfaceMesh soup;
  soup.position_m.resize(3 * mesh.triangle.rows(), 3);
  soup.triangle.resize(mesh.triangle.rows(), 3);
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      soup.position_m.row(3 * t + j) = mesh.position_m.row(mesh.triangle(t, j));
      soup.triangle(t, j) = static_cast<std::int32_t>(3 * t + j);
    }
  }
  return soup;
}

SurfaceMesh without_triangles(SurfaceMesh mesh, Eigen::Index count) {
  mesh.triangle.conservativeResize(mesh.triangle.rows() - count, 3);
  return mesh;
}

std::size_t changes(const RepairReport& report, std::string_view what) {
  for (const RepairStep& step : report.changed) {
    if (step.what == what) {
      return step.count;
    }
  }
  return 0;
}

void expect_originals_in_place(const RepairedSurface& repaired, const SurfaceMesh& of) {
  const std::vector<std::int32_t>& original = repaired.report.original_vertex;
  ASSERT_EQ(std::ssize(original), repaired.mesh.position_m.rows());
  for (std::size_t v = 0; v < original.size(); ++v) {
    if (original[v] >= 0) {
      EXPECT_EQ(repaired.mesh.position_m.row(static_cast<Eigen::Index>(v)),
                of.position_m.row(original[v]));
    }
    if (v > 0 && original[v] >= 0) {
      EXPECT_LT(original[v - 1], original[v]);
      EXPECT_GE(original[v - 1], 0);
    }
  }
}

// Without the triangles whose centre lies above z.
SurfaceMesh cut_open(const SurfaceMesh& mesh, double z_m) {
  SurfaceMesh open = mesh;
  Eigen::Index kept = 0;
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); ++t) {
    double z = 0.0;
    for (int j = 0; j < 3; ++j) {
      z += mesh.position_m(mesh.triangle(t, j), 2) / 3.0;
    }
    if (z < z_m) {
      open.triangle.row(kept++) = mesh.triangle.row(t);
    }
  }
  open.triangle.conservativeResize(kept, 3);
  return open;
}

TEST(Repair, LeavesAGoodBodyAlone) {
  const SurfaceMesh mesh = organ(2);
  for (const RepairMode mode :
       {RepairMode::kOff, RepairMode::kSafe, RepairMode::kWrap}) {
    const RepairedSurface repaired = repair_surface(mesh, mode);
    EXPECT_EQ(repaired.report.refusal, "");
    EXPECT_TRUE(repaired.report.changed.empty());
    EXPECT_EQ(repaired.mesh.position_m, mesh.position_m);
    EXPECT_EQ(repaired.mesh.triangle, mesh.triangle);
    expect_originals_in_place(repaired, mesh);
  }
}

TEST(Repair, WeldsATriangleSoupIntoTheBodyThatItWas) {
  const SurfaceMesh mesh = organ(2);
  const SurfaceMesh soup = exploded(mesh);
  const RepairedSurface repaired = repair_surface(soup, RepairMode::kSafe);
  EXPECT_EQ(repaired.report.refusal, "");
  EXPECT_EQ(repaired.mesh.position_m.rows(), mesh.position_m.rows());
  EXPECT_EQ(repaired.mesh.triangle.rows(), mesh.triangle.rows());
  EXPECT_EQ(changes(repaired.report, "duplicate vertices welded"),
            static_cast<std::size_t>(soup.position_m.rows() - mesh.position_m.rows()));
  EXPECT_NEAR(enclosed_volume_m3(repaired.mesh) / enclosed_volume_m3(mesh), 1.0, 1e-12);
  expect_originals_in_place(repaired, soup);
}

TEST(Repair, TakesOutDuplicatesAndStrays) {
  SurfaceMesh mesh = icosphere(0.01, 2);
  const SurfaceMesh good = mesh;
  mesh.triangle.conservativeResize(mesh.triangle.rows() + 2, 3);
  mesh.triangle.row(mesh.triangle.rows() - 2) = mesh.triangle.row(7).reverse().eval();
  mesh.triangle.row(mesh.triangle.rows() - 1) << 3, 3, 5;
  mesh.position_m.conservativeResize(mesh.position_m.rows() + 1, 3);
  mesh.position_m.bottomRows(1) << 1.0, 2.0, 3.0;
  const RepairedSurface repaired = repair_surface(mesh, RepairMode::kSafe);
  EXPECT_EQ(repaired.report.refusal, "");
  EXPECT_EQ(changes(repaired.report, "duplicate triangles taken out"), 1U);
  EXPECT_EQ(changes(repaired.report, "collapsed triangles taken out"), 1U);
  EXPECT_EQ(changes(repaired.report, "vertices of no triangle taken out"), 1U);
  EXPECT_EQ(repaired.mesh.position_m, good.position_m);
}

TEST(Repair, TurnsTrianglesThatFaceTheWrongWay) {
  SurfaceMesh mesh = icosphere(0.01, 2);
  for (const Eigen::Index t : {4, 100, 101}) {
    std::swap(mesh.triangle(t, 0), mesh.triangle(t, 1));
  }
  const RepairedSurface repaired = repair_surface(mesh, RepairMode::kSafe);
  EXPECT_EQ(repaired.report.refusal, "");
  EXPECT_EQ(changes(repaired.report, "triangles turned to agree with their neighbours"),
            3U);
  EXPECT_EQ(repaired.mesh.position_m, mesh.position_m);
  EXPECT_GT(enclosed_volume_m3(repaired.mesh), 0.0);
}

TEST(Repair, FillsASmallHoleWithoutNewVertices) {
  const SurfaceMesh mesh = without_triangles(icosphere(0.01, 3), 2);
  const RepairedSurface repaired = repair_surface(mesh, RepairMode::kSafe);
  EXPECT_EQ(repaired.report.refusal, "");
  EXPECT_EQ(changes(repaired.report, "holes filled"), 1U);
  EXPECT_EQ(repaired.mesh.position_m, mesh.position_m);
  EXPECT_EQ(repaired.mesh.triangle.rows(), mesh.triangle.rows() + 2);
}

TEST(Repair, DoesNotMakeABodyOfAnOpenSheet) {
  const SurfaceMesh half = without_triangles(icosphere(0.01, 3), 640);
  const RepairedSurface repaired = repair_surface(half, RepairMode::kSafe);
  EXPECT_NE(repaired.report.refusal.find("open"), std::string::npos)
      << repaired.report.refusal;
}

TEST(Repair, NeverLosesAPart) {
  SurfaceMesh far = icosphere(0.01, 2);
  far.position_m.col(0).array() += 0.05;
  const SurfaceMesh two = joined(without_triangles(icosphere(0.01, 2), 1), far);
  const RepairedSurface repaired = repair_surface(two, RepairMode::kSafe);
  EXPECT_EQ(repaired.report.refusal, "");
  EXPECT_EQ(repaired.report.after.components, 2);
}

TEST(Repair, WrapsWhatSafeRefuses) {
  SurfaceMesh other = icosphere(0.01, 2);
  other.position_m.rowwise() += Eigen::RowVector3d(0.012, 0.001, 0.0005);
  const SurfaceMesh crossing = joined(icosphere(0.01, 2), other);
  const RepairedSurface wrapped = repair_surface(crossing, RepairMode::kWrap);
  EXPECT_EQ(wrapped.report.refusal, "");
  EXPECT_EQ(wrapped.report.after.components, 1);
  EXPECT_GT(wrapped.report.displaced_m, 0.0);
  // Two balls less what they share; a wrap lies outside by its offset.
  const double one_m3 = enclosed_volume_m3(other);
  EXPECT_GT(wrapped.report.after.volume_m3, 1.6 * one_m3);
  EXPECT_LT(wrapped.report.after.volume_m3, 2.0 * one_m3);
}

// A tooth is scanned without its root: a wide hole, and some triangles that cross.
TEST(Repair, ClosesAWideHoleBeforeItWraps) {
  const double radius_m = 0.01;
  SurfaceMesh open = cut_open(icosphere(radius_m, 4), 0.4 * radius_m);
  open.position_m.row(open.triangle(10, 0)) *= 0.6;  // a dent that crosses others
  const RepairedSurface wrapped = repair_surface(open, RepairMode::kWrap);
  EXPECT_EQ(wrapped.report.refusal, "");
  EXPECT_EQ(changes(wrapped.report, "holes filled"), 1U);
  // A ball whose cap of height h is cut off: pi h^2 (R - h / 3) is missing.
  const double h = 0.6;
  const double left = 1.0 - 0.75 * h * h * (1.0 - h / 3.0);
  const double ball_m3 = enclosed_volume_m3(icosphere(radius_m, 4));
  EXPECT_NEAR(wrapped.report.after.volume_m3 / ball_m3, left, 0.05);
}

TEST(Repair, RefusesAWrapOfWhatEnclosesNothing) {
  SurfaceMesh sheet = icosphere(0.01, 1);
  sheet.triangle.conservativeResize(1, 3);
  const RepairedSurface wrapped = repair_surface(sheet, RepairMode::kWrap);
  EXPECT_NE(wrapped.report.refusal.find("hollow"), std::string::npos)
      << wrapped.report.refusal;
}

TEST(ShareOutside, TellsAShellFromABall) {
  const SurfaceMesh ball = icosphere(0.01, 3);
  SurfaceMesh inner = icosphere(0.0098, 3);
  EXPECT_EQ(share_outside(ball, ball), 0.0);
  inner.triangle.col(1).swap(inner.triangle.col(2));
  EXPECT_GT(share_outside(ball, joined(ball, inner)), 0.9);
  SurfaceMesh half = icosphere(0.01, 3);
  half.position_m.col(2) = half.position_m.col(2).cwiseMax(0.0);
  EXPECT_NEAR(share_outside(ball, half), 0.5, 0.05);
}

TEST(Repair, MendsARealLiver) {
  const auto file = test_data("meshes/sofa_liver-smooth.obj");
  if (!file) {
    GTEST_SKIP() << "no test data";
  }
  const SurfaceMesh mesh = read_surface(*file, "cm");
  const RepairedSurface safe = repair_surface(mesh, RepairMode::kSafe);
  EXPECT_EQ(safe.report.refusal, "");
  EXPECT_EQ(safe.report.before.self_intersections.count, 7U);
  EXPECT_TRUE(safe.report.after.accepted());
  EXPECT_LT(std::abs(safe.report.volume_relative), 0.001);
  const auto gone = mesh.position_m.rows() -
                    std::count_if(safe.report.original_vertex.begin(),
                                  safe.report.original_vertex.end(), [](int v) {
                                    return v >= 0;
                                  });
  EXPECT_LT(gone, 20);  // of 2194
  expect_originals_in_place(safe, mesh);
  const RepairedSurface wrapped = repair_surface(mesh, RepairMode::kWrap);
  EXPECT_EQ(wrapped.report.refusal, "");
  EXPECT_GT(wrapped.report.volume_relative, 0.0);
  EXPECT_LT(wrapped.report.volume_relative, 0.1);
}

// Triangles that were turned change the sign of what they enclose, not the volume.
TEST(Repair, StatesNoChangeOfAVolumeThatWasUnknown) {
  SurfaceMesh mesh = organ(2);
  for (Eigen::Index t = 0; t < mesh.triangle.rows(); t += 5) {
    mesh.triangle.row(t) = mesh.triangle.row(t).reverse().eval();
  }
  const RepairedSurface turned = repair_surface(mesh, RepairMode::kSafe);
  EXPECT_EQ(turned.report.refusal, "");
  EXPECT_FALSE(turned.report.before.has_volume());
  EXPECT_TRUE(turned.report.after.has_volume());
  EXPECT_TRUE(std::isnan(turned.report.volume_relative));
  SurfaceMesh inside_out = organ(2);
  inside_out.triangle.col(1).swap(inside_out.triangle.col(2));
  const RepairedSurface whole = repair_surface(inside_out, RepairMode::kSafe);
  EXPECT_TRUE(whole.report.before.has_volume());
  EXPECT_NEAR(whole.report.volume_relative, 0.0, 1e-12);
}

TEST(RepairedBody, SaysWhatToTryNext) {
  std::vector<std::string> notes;
  const SurfaceMesh open = without_triangles(icosphere(0.01, 3), 2);
  try {
    (void)require_body(open, RepairMode::kOff, "liver.obj", notes);
    FAIL() << "took an open surface";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("--repair=safe makes a body of it"),
              std::string::npos);
  }
  EXPECT_TRUE(
      require_body(open, RepairMode::kSafe, "liver.obj", notes).report.accepted());
  EXPECT_EQ(notes, std::vector<std::string>{"liver.obj: repair: 1 holes filled"});
}

TEST(RepairedBody, NamesTheRepairThatWorks) {
  std::vector<std::string> notes;
  const auto advice = [&](const SurfaceMesh& mesh, RepairMode mode) -> std::string {
    try {
      (void)require_body(mesh, mode, "tooth.stl", notes);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  };
  const SurfaceMesh wide = cut_open(icosphere(0.01, 3), 0.004);
  for (const RepairMode mode : {RepairMode::kOff, RepairMode::kSafe}) {
    const std::string said = advice(wide, mode);
    EXPECT_NE(said.find("--repair=wrap makes a body of it"), std::string::npos) << said;
    EXPECT_EQ(said.find("--repair=safe"), std::string::npos) << said;
  }
  SurfaceMesh sheet = icosphere(0.01, 1);
  sheet.triangle.conservativeResize(1, 3);
  EXPECT_NE(advice(sheet, RepairMode::kOff).find("mend it by hand"), std::string::npos);
}

TEST(RepairMode, KnowsItsNames) {
  EXPECT_EQ(repair_mode("off"), RepairMode::kOff);
  EXPECT_EQ(repair_mode("safe"), RepairMode::kSafe);
  EXPECT_EQ(repair_mode("wrap"), RepairMode::kWrap);
  EXPECT_THROW((void)repair_mode("auto"), InputError);
}

TEST(SurfaceSoup, KeepsTheOrderOfWhatStays) {
  SurfaceMesh mesh = icosphere(0.01, 1);
  const SurfaceMesh soup = joined(mesh, mesh);
  SoupChanges taken;
  const SurfaceMesh clean = clean_soup(soup, taken);
  EXPECT_EQ(clean.position_m, mesh.position_m);
  EXPECT_EQ(clean.triangle, mesh.triangle);
  EXPECT_EQ(taken.welded_vertices, static_cast<std::size_t>(mesh.position_m.rows()));
  EXPECT_EQ(taken.duplicate_triangles, static_cast<std::size_t>(mesh.triangle.rows()));
}

}  // namespace
}  // namespace palpate
