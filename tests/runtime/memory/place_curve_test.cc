#include "runtime/memory/place_curve.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "runtime/bench/bench_body.h"

namespace palpate {
namespace {

constexpr double kCurveDepthM = 0.008;

// Three nodes of another stiffness, lean and touch each.
class PlaceCurveTest : public testing::Test {
 protected:
  explicit PlaceCurveTest(double exponent = 1.5, int bundles = 1)
      : body_(make_bench_body({.cells = 1,
                               .exponent = exponent,
                               .depth_m = kCurveDepthM,
                               .contrast = 9.0,
                               .relaxing = {0.5},
                               .relaxation_s = {1.0},
                               .bundles = bundles})),
        element_(body_.element[0]) {
    take();
  }

  void take() {
    nodes_ = make_place_nodes(element_, {0.9, 1.0, 0.7}, {1e-4, -2e-4, 0.0});
  }

  [[nodiscard]] PlaceCurve curve() const { return {element_, nodes_, weight_}; }

  // By the curves themselves.
  [[nodiscard]] ElementSample sum(double y) const {
    ElementSample all;
    for (std::size_t j = 0; j < 3; ++j) {
      const double c = nodes_.lean[j];
      const ElementSample at = element_.node[j].curve().at(c * (y - nodes_.touch_m[j]));
      const double w = weight_(static_cast<Eigen::Index>(j));
      all.force_n += w * c * at.force_n;
      all.stiffness_n_per_m += w * c * c * at.stiffness_n_per_m;
      all.energy_j += w * at.energy_j;
    }
    return all;
  }

  BenchBody body_;
  Element element_;
  PlaceNodes nodes_;
  NodeValues weight_{0.5, 0.3, 0.2, 0.0};
};

class CutCurve : public PlaceCurveTest {
 protected:
  CutCurve() : PlaceCurveTest(2.0, 8) {}
};

TEST_F(PlaceCurveTest, IsTheBlendOfTheNodesCurves) {
  NodePieces pieces;
  for (double y = -0.001; y < 0.02; y += 3.7e-5) {
    const PlacePoint at = point_at(curve(), 0, y, pieces);
    const ElementSample wanted = sum(y);
    EXPECT_NEAR(at.force_n, wanted.force_n, 1e-13) << y;
    EXPECT_NEAR(at.stiffness_n_per_m, wanted.stiffness_n_per_m, 1e-9) << y;
    EXPECT_NEAR(at.energy_j, wanted.energy_j, 1e-16) << y;
    const PlaceCubic cubic = cubic_around(curve(), 0, y, pieces);
    for (const double beside : {0.3 * cubic.low_m + 0.7 * y, y}) {
      if (cubic.holds(beside)) {
        EXPECT_NEAR(cubic.force_at(beside), sum(beside).force_n, 1e-13) << y;
        EXPECT_NEAR(cubic.energy_at(beside), sum(beside).energy_j, 1e-16) << y;
      }
    }
  }
}

TEST_F(PlaceCurveTest, InverseFindsTheDepthOfAForceFromAnywhere) {
  for (const double near : {-1.0, 1e-5, 0.003, 0.011}) {
    PlaceCubic cubic;
    NodePieces pieces;
    for (const double y : {-5e-5, 2e-4, 0.001, 0.0043, 0.008, 0.0119}) {
      const ElementSample at = sum(y);
      const CurveInverse found =
          inverse(curve(), 0, at.force_n, near, 0.012, cubic, pieces);
      // The last step leaves 3e-3^3 of the force; energy is stationary there.
      EXPECT_NEAR(sum(found.depth_m).force_n, at.force_n, 3e-8 * at.force_n) << y;
      EXPECT_NEAR(at.force_n * found.depth_m - found.energy_j,
                  at.force_n * y - at.energy_j, 1e-18 + 1e-13 * at.energy_j)
          << y;
    }
  }
}

TEST_F(PlaceCurveTest, InverseOfNoForceIsTheFirstTouch) {
  PlaceCubic cubic;
  NodePieces pieces;
  const CurveInverse found = inverse(curve(), 0, 0.0, 0.004, 0.012, cubic, pieces);
  EXPECT_EQ(found.depth_m, -2e-4);
  EXPECT_EQ(found.energy_j, 0.0);
}

TEST_F(CutCurve, BundlesSumToTheCurve) {
  for (double y = -0.001; y < 0.015; y += 1.3e-4) {
    PlacePoint all;
    for (int b = 0; b < 8; ++b) {
      NodePieces pieces;
      const PlacePoint at = point_at(curve(), b, y, pieces);
      EXPECT_GE(at.force_n, -1e-15) << y;
      EXPECT_GE(at.stiffness_n_per_m, -1e-9) << y;
      all.force_n += at.force_n;
      all.stiffness_n_per_m += at.stiffness_n_per_m;
      all.energy_j += at.energy_j;
    }
    EXPECT_NEAR(all.force_n, sum(y).force_n, 1e-13) << y;
    EXPECT_NEAR(all.stiffness_n_per_m, sum(y).stiffness_n_per_m, 1e-9) << y;
    EXPECT_NEAR(all.energy_j, sum(y).energy_j, 1e-16) << y;
  }
}

TEST_F(CutCurve, ABundleIsTouchedAtItsCutAndGoesOnStraightFromTheNext) {
  const double cut = element_.memory.node[1].cut_m[3];
  const double next = element_.memory.node[1].cut_m[4];
  weight_ = {0.0, 1.0, 0.0, 0.0};
  NodePieces pieces;
  const double touch = nodes_.touch_m[1];
  EXPECT_EQ(point_at(curve(), 4, touch + 0.99 * cut, pieces).force_n, 0.0);
  EXPECT_GT(point_at(curve(), 4, touch + 1.05 * cut, pieces).force_n, 0.0);
  const double at = point_at(curve(), 4, touch + 1.1 * next, pieces).force_n;
  const double middle = point_at(curve(), 4, touch + 1.2 * next, pieces).force_n;
  const double beyond = point_at(curve(), 4, touch + 1.3 * next, pieces).force_n;
  EXPECT_NEAR(beyond - middle, middle - at, 1e-13);
}

TEST_F(CutCurve, PiecesOfOneDepthServeTheNext) {
  NodePieces kept;
  for (double y = -0.001; y < 0.015; y += 7.7e-6) {
    NodePieces fresh;
    const PlacePoint a = point_at(curve(), 3, y, kept);
    const PlacePoint b = point_at(curve(), 3, y, fresh);
    ASSERT_NEAR(a.force_n, b.force_n, 1e-14) << y;
    ASSERT_NEAR(a.energy_j, b.energy_j, 1e-17) << y;
  }
}

TEST(RisingPiece, IsTheCurveWhereItDoesNotFall) {
  ElementNode node;
  set_power_law(node, 1.5, 2.0, kCurveDepthM);
  for (double d = 1e-6; d < 0.012; d += 9.1e-6) {
    const ElementSample own = node.curve().at(d);
    const ElementSample rising = rising_piece_around(node.curve(), d).at(d);
    ASSERT_NEAR(rising.force_n, own.force_n, 1e-14) << d;
    ASSERT_NEAR(rising.stiffness_n_per_m, own.stiffness_n_per_m, 1e-10) << d;
    ASSERT_NEAR(rising.energy_j, own.energy_j, 1e-17) << d;
  }
}

// Up to 1 N, down to 0.6 N, up to 2 N.
ElementNode bumpy() {
  ElementNode node;
  node.samples = 5;
  node.depth_m = {0.0, 1e-3, 2e-3, 3e-3, 4e-3};
  node.force_n = {0.0, 1.0, 0.6, 1.2, 2.0};
  node.stiffness_n_per_m = {800.0, 0.0, 0.0, 700.0, 800.0};
  for (std::size_t i = 1; i < 5; ++i) {
    const double h = 1e-3;
    node.energy_j[i] =
        node.energy_j[i - 1] + h * (node.force_n[i - 1] + node.force_n[i]) / 2.0 +
        h * h * (node.stiffness_n_per_m[i - 1] - node.stiffness_n_per_m[i]) / 12.0;
  }
  return node;
}

TEST(RisingPiece, PassesTheRunningMaximaAndNeverFalls) {
  const ElementNode node = bumpy();
  const auto at = [&](double d) {
    return rising_piece_around(node.curve(), d).at(d);
  };
  EXPECT_NEAR(at(1e-3).force_n, 1.0, 1e-15);
  EXPECT_NEAR(at(1.7e-3).force_n, 1.0, 1e-15);
  EXPECT_NEAR(at(2e-3).force_n, 1.0, 1e-15);
  EXPECT_NEAR(at(3e-3).force_n, 1.2, 1e-15);
  EXPECT_NEAR(at(5e-3).force_n, 2.8, 1e-12);
  double last_n = 0.0;
  double last_j = 0.0;
  for (double d = 1e-6; d < 6e-3; d += 1e-6) {
    const ElementSample now = at(d);
    ASSERT_GE(now.force_n, last_n - 1e-14) << d;
    // The energy is the force's integral: 1e-6 m of it, by the trapezoid.
    ASSERT_NEAR(now.energy_j - last_j, 0.5e-6 * (now.force_n + last_n), 1e-12) << d;
    last_n = now.force_n;
    last_j = now.energy_j;
  }
}

TEST(RisingPiece, OfACurveThatEndsBelowItsMaximumStaysThere) {
  ElementNode node = bumpy();
  node.samples = 3;
  EXPECT_NEAR(rising_piece_around(node.curve(), 0.01).at(0.01).force_n, 1.0, 1e-15);
  EXPECT_NEAR(rising_piece_around(node.curve(), 0.01).at(0.01).stiffness_n_per_m, 0.0,
              1e-15);
}

}  // namespace
}  // namespace palpate
