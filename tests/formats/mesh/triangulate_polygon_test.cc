#include "formats/mesh/triangulate_polygon.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace palpate {
namespace {

using Polygon = std::vector<Eigen::Vector3d>;

// Sum of the triangles' areas; equals the polygon's only if none of them overlap.
double area_m2(const Polygon& p) {
  double sum = 0.0;
  for (const auto& t : triangulate_polygon(p)) {
    sum += 0.5 * (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).norm();
  }
  return sum;
}

TEST(TriangulatePolygon, CutsAQuadrangleAlongItsShorterDiagonal) {
  const Polygon kite{{0, -3, 0}, {1, 0, 0}, {0, 3, 0}, {-1, 0, 0}};
  for (const auto& t : triangulate_polygon(kite)) {
    EXPECT_EQ(std::count(t.begin(), t.end(), 1U), 1);
    EXPECT_EQ(std::count(t.begin(), t.end(), 3U), 1);
  }
}

TEST(TriangulatePolygon, StaysInsideConcavePolygons) {
  const Polygon arrow{{0, 0, 0}, {2, -1, 0}, {0, 3, 0}, {-2, -1, 0}};
  EXPECT_NEAR(area_m2(arrow), 6.0, 1e-14);
  const Polygon letter{{0, 0, 1}, {3, 0, 1}, {3, 1, 1}, {1, 1, 1},
                       {1, 2, 1}, {3, 2, 1}, {3, 3, 1}, {0, 3, 1}};
  EXPECT_NEAR(area_m2(letter), 7.0, 1e-14);
}

// n^2, not n^3: minutes otherwise. A comb, whose teeth block each other's ears.
TEST(TriangulatePolygon, CutsThousandsOfCorners) {
  Polygon comb;
  constexpr int kTeeth = 2000;
  for (int k = 0; k < kTeeth; ++k) {
    comb.emplace_back(k, 0.0, 0.0);
    comb.emplace_back(k + 0.5, 50.0, 0.0);
  }
  comb.emplace_back(kTeeth, 0.0, 0.0);
  comb.emplace_back(0.5 * kTeeth, -10.0, 0.0);
  double area = 0.0;
  for (std::size_t i = 0; i < comb.size(); ++i) {
    const auto& a = comb[i];
    const auto& b = comb[(i + 1) % comb.size()];
    area += 0.5 * (a.x() * b.y() - b.x() * a.y());
  }
  EXPECT_NEAR(area_m2(comb), std::abs(area), 1e-6);
}

TEST(TriangulatePolygon, FacesTheSameWayAsThePolygon) {
  Polygon ring;
  for (int k = 0; k < 9; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / 9;
    ring.emplace_back(std::cos(angle), 0.0, -std::sin(angle));  // about +y
  }
  const auto triangles = triangulate_polygon(ring);
  EXPECT_EQ(triangles.size(), 7U);
  for (const auto& t : triangles) {
    EXPECT_GT((ring[t[1]] - ring[t[0]]).cross(ring[t[2]] - ring[t[0]]).y(), 0.0);
  }
}

TEST(TriangulatePolygon, EndsOnPolygonsWithoutAnEar) {
  EXPECT_EQ(triangulate_polygon(Polygon(5, Eigen::Vector3d::Zero())).size(), 3U);
  const Polygon bow{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_EQ(triangulate_polygon(bow).size(), 2U);
}

}  // namespace
}  // namespace palpate
