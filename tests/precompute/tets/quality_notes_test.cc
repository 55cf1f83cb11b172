#include "precompute/tets/quality_notes.h"

#include <cmath>

#include <gtest/gtest.h>

#include "precompute/surface/primitive_bodies.h"
#include "tests/support/study_bodies.h"

namespace palpate {
namespace {

TEST(QualityNotes, AreSilentOnAGoodSurface) {
  EXPECT_TRUE(quality_notes(check_surface(organ(2)).report).empty());
}

TEST(QualityNotes, NameANeedleOfASurface) {
  const auto notes =
      quality_notes(check_surface(ellipsoid({1.0, 0.01, 0.01}, 2)).report);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("poor surface"), std::string::npos);
}

TEST(QualityNotes, NameTheEdgeThatMakesAUsefulNumberOfTriangles) {
  SurfaceReport report;
  report.smallest_angle_rad = 0.5;
  report.area_m2 = 0.25 * std::sqrt(3.0) * 30000.0 * 1.5e-3 * 1.5e-3;
  report.triangles = 140000;
  EXPECT_TRUE(quality_notes(report).empty());
  report.triangles = 1000000;
  const auto notes = quality_notes(report);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("remesh MESH --edge-m 0.0015 -o OUT"), std::string::npos)
      << notes[0];
}

TEST(QualityNotes, NameAFlatTet) {
  EXPECT_TRUE(
      quality_notes(TetQuality{.smallest_dihedral_rad = 1.1 * kDegree}).empty());
  const auto notes = quality_notes(TetQuality{.smallest_dihedral_rad = 0.5 * kDegree});
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("0.5 deg"), std::string::npos) << notes[0];
}

}  // namespace
}  // namespace palpate
