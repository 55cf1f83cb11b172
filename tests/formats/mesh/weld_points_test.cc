#include "formats/mesh/weld_points.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace {

using WeldedPoints = std::vector<Eigen::Vector3d>;
using Firsts = std::vector<std::size_t>;

// By trying all pairs, as the header says it.
Firsts first_of_pairs(const WeldedPoints& points, double tolerance) {
  Firsts first;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::size_t found = i;
    for (std::size_t j = 0; j < i && found == i; ++j) {
      const bool near = (points[i] - points[j]).cwiseAbs().maxCoeff() <= tolerance;
      found = near && first[j] == j ? j : i;
    }
    first.push_back(found);
  }
  return first;
}

TEST(WeldPoints, RoundingIsFourFloatStepsOfTheLargestCoordinate) {
  EXPECT_EQ(rounding_of({{1.0, -8.0, 2.0}, {3.0, 0.0, 0.0}}),
            4.0 * std::ldexp(1.0, -23) * 8.0);
  EXPECT_EQ(rounding_of({}), 0.0);
  EXPECT_EQ(rounding_of({{0.0, 0.0, 0.0}}), 0.0);
}

TEST(WeldPoints, OneWithinTheToleranceInEveryCoordinateIsTheEarlier) {
  const WeldedPoints points{{0.0, 0.0, 0.0},
                            {1.0, 0.0, 0.0},
                            {0.25, -0.25, 0.25},
                            {0.0, 0.0, 0.2500001},
                            {1.0, 0.2, -0.1}};
  EXPECT_EQ(first_within(points, 0.25), (Firsts{0, 1, 0, 3, 1}));
}

TEST(WeldPoints, OneThatWasGivenAnotherTakesNoneWithIt) {
  const WeldedPoints row{
      {0.0, 0.0, 0.0}, {0.8, 0.0, 0.0}, {1.6, 0.0, 0.0}, {2.4, 0.0, 0.0}};
  EXPECT_EQ(first_within(row, 1.0), (Firsts{0, 0, 2, 2}));
}

TEST(WeldPoints, TheFirstOfSeveralIsTaken) {
  EXPECT_EQ(first_within({{0.0, 0.0, 0.0}, {1.5, 0.0, 0.0}, {0.75, 0.0, 0.0}}, 1.0),
            (Firsts{0, 1, 0}));
}

TEST(WeldPoints, NeighboursAreFoundAcrossTheCellsBorders) {
  const double tolerance = 1e-3;
  const double border = 256.0 * tolerance;
  for (const double at : {border, 0.0, -border, 3.0 * border}) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      Eigen::Vector3d below = Eigen::Vector3d::Constant(at);
      Eigen::Vector3d above = below;
      below(axis) -= 0.4 * tolerance;
      above(axis) += 0.4 * tolerance;
      EXPECT_EQ(first_within({below, above}, tolerance), (Firsts{0, 0})) << at;
      EXPECT_EQ(first_within({above, below}, tolerance), (Firsts{0, 0})) << at;
    }
  }
}

TEST(WeldPoints, DoesAsAllPairsDo) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const double tolerance : {1e-3, 0.02, 0.3}) {
    WeldedPoints points;
    for (int i = 0; i < 300; ++i) {
      points.emplace_back(unit(random), unit(random), 0.1 * unit(random));
    }
    EXPECT_EQ(first_within(points, tolerance), first_of_pairs(points, tolerance));
  }
}

TEST(WeldPoints, WithoutAToleranceOrPlacesEachIsItself) {
  const double nan = std::nan("");
  const double infinite = std::numeric_limits<double>::infinity();
  const WeldedPoints same{{1.0, 1.0, 1.0}, {1.0, 1.0, 1.0}};
  for (const double tolerance : {0.0, -1.0, nan, infinite}) {
    EXPECT_EQ(first_within(same, tolerance), (Firsts{0, 1})) << tolerance;
  }
  EXPECT_EQ(first_within({{nan, 0.0, 0.0},
                          {nan, 0.0, 0.0},
                          {0.0, infinite, 0.0},
                          {0.0, infinite, 0.0},
                          {0.0, 0.0, 0.0},
                          {0.0, 0.0, 0.0}},
                         0.1),
            (Firsts{0, 1, 2, 3, 4, 4}));
}

}  // namespace
}  // namespace palpate
