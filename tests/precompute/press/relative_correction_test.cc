#include "precompute/press/relative_correction.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr double kFrom = -1e-4;
const Eigen::Vector3d kDirection(0.3, -0.1, 0.2);
using Knot = RelativeCorrection::Knot;

// Through f at some penetrations.
template <typename Function>
RelativeCorrection through(const Function& f) {
  std::array<Knot, 4> knots;
  const std::array<double, 4> at{0.4e-3, 0.7e-3, 1.3e-3, 2e-3};
  for (std::size_t i = 0; i < 4; ++i) {
    knots[i] = {at[i], f(at[i]) * kDirection};
  }
  return {kFrom, knots};
}

TEST(RelativeCorrection, OfAStraightLineIsTheLine) {
  const auto line = [](double x) {
    return 100.0 * (x - kFrom);
  };
  const RelativeCorrection correction = through(line);
  for (double x = kFrom; x <= 2e-3; x += 5e-5) {
    EXPECT_LT((correction.at(x) - line(x) * kDirection).norm(), 1e-15) << x;
  }
}

TEST(RelativeCorrection, WeighsTheSecantsOfUnevenWidths) {
  // Fritsch and Butland by hand: widths 1 and 2, secants 1 and 4 give
  // 9 / (5 / 1 + 4 / 4) = 1.5 between them; 1/4 and 2 give 9 / (20 + 2).
  const std::array<Knot, 2> knots{
      Knot{1.0, Eigen::Vector3d(1.0, 0.25, -1.0)},
      Knot{3.0, Eigen::Vector3d(9.0, 4.25, 3.0)},
  };
  const RelativeCorrection correction(0.0, knots);
  // a + rise / 2 + (slope_a - slope_b) width / 8 in the middle of an interval.
  const Eigen::Vector3d first(0.5 + (1.0 - 1.5) / 8.0,
                              0.125 + (0.25 - 9.0 / 22.0) / 8.0, -0.5 - 1.0 / 8.0);
  const Eigen::Vector3d second(5.0 + (1.5 - 4.0) / 4.0, 2.25 + (9.0 / 22.0 - 2.0) / 4.0,
                               1.0 + (0.0 - 2.0) / 4.0);
  EXPECT_LT((correction.at(0.5) - first).norm(), 1e-14);
  EXPECT_LT((correction.at(2.0) - second).norm(), 1e-14);
}

TEST(RelativeCorrection, IsZeroBeforeTheFirstTouchAndConstantBeyondTheLastKnot) {
  const RelativeCorrection correction = through([](double x) {
    return 1e3 * (x - kFrom);
  });
  EXPECT_EQ(correction.at(kFrom - 1.0).norm(), 0.0);
  EXPECT_EQ(correction.at(kFrom).norm(), 0.0);
  EXPECT_EQ(correction.at(1.0), correction.at(2e-3));
}

TEST(RelativeCorrection, IsSmoothGoesThroughItsKnotsAndFollowsACurve) {
  const auto curve = [](double x) {
    return std::pow(1e3 * (x - kFrom), 1.5);
  };
  const RelativeCorrection correction = through(curve);
  constexpr double kStep = 1e-9;
  for (const double knot : {0.4e-3, 0.7e-3, 1.3e-3}) {
    EXPECT_LT((correction.at(knot) - curve(knot) * kDirection).norm(), 1e-14);
    const Eigen::Vector3d before =
        (correction.at(knot) - correction.at(knot - kStep)) / kStep;
    const Eigen::Vector3d after =
        (correction.at(knot + kStep) - correction.at(knot)) / kStep;
    EXPECT_LT((after - before).norm(), 1e-4 * before.norm()) << knot;
  }
  for (double x = 0.4e-3; x <= 1.3e-3; x += 5e-5) {
    EXPECT_NEAR(correction.at(x).x() / (curve(x) * kDirection.x()), 1.0, 0.02) << x;
  }
}

// Fritsch and Butland 1984: secants 1 over a width of 1, 2 over a width of 2, weighted
// 2 * 2 + 1 and 2 + 2 * 1: 9 / (5 / 1 + 4 / 2).
TEST(RelativeCorrection, SlopesAreHarmonicMeansWeightedByWidths) {
  const std::array<Knot, 2> knots{Knot{1e-3, kDirection}, Knot{3e-3, 5.0 * kDirection}};
  const RelativeCorrection correction(0.0, knots);
  constexpr double kStep = 1e-8;
  const Eigen::Vector3d slope =
      (correction.at(1e-3 + kStep) - correction.at(1e-3 - kStep)) / (2.0 * kStep);
  EXPECT_LT((slope - 9.0 / 7.0 * 1e3 * kDirection).norm(), 1e-4 * slope.norm());
}

TEST(RelativeCorrection, DoesNotOvershootWhereKnotsTurn) {
  const std::array<Knot, 3> knots{Knot{1e-3, kDirection}, Knot{2e-3, 3.0 * kDirection},
                                  Knot{3e-3, 1.0 * kDirection}};
  const RelativeCorrection correction(0.0, knots);
  for (double x = 0.0; x <= 3e-3; x += 1e-5) {
    EXPECT_LE(correction.at(x).x(), 3.0 * kDirection.x() * (1.0 + 1e-12));
    EXPECT_GE(correction.at(x).x(), 0.0);
  }
}

TEST(RelativeCorrection, OfOneKnotIsTheLineToIt) {
  const std::array<Knot, 1> knots{Knot{1e-3, kDirection}};
  const RelativeCorrection correction(0.0, knots);
  EXPECT_LT((correction.at(0.25e-3) - 0.25 * kDirection).norm(), 1e-15);
  EXPECT_LT((correction.at(0.5e-3) - 0.5 * kDirection).norm(), 1e-15);
}

}  // namespace
}  // namespace palpate
