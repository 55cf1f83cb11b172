#include "precompute/press/interpolation_error.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace {

using Knot = RelativeCorrection::Knot;
using Function = std::function<double(double)>;

constexpr double kSample = 1e-4;  // [m] between two
const Eigen::Vector3d kAlong(0.0, 0.6, -0.8);

double constant(double /*sample*/) {
  return 2.0;
}

// Samples at 0, 1, ... last, with forces of norm `force_n`.
std::vector<IndentationSample> path_to(int last, const Function& force_n = constant) {
  std::vector<IndentationSample> path;
  for (int k = 0; k <= last; ++k) {
    path.push_back({.penetration_m = k * kSample,
                    .force_n = force_n(k) * Eigen::Vector3d::UnitZ()});
  }
  return path;
}

std::vector<Knot> knots_at(const std::vector<int>& samples, const Function& f) {
  std::vector<Knot> knots;
  for (const int k : samples) {
    knots.push_back({k * kSample, f(k) * kAlong});
  }
  return knots;
}

double stated(const std::vector<int>& samples, const Function& f) {
  return interpolation_error(path_to(samples.back()), knots_at(samples, f));
}

double found(const std::vector<int>& samples, const Function& f) {
  const RelativeCorrection correction(0.0, knots_at(samples, f));
  double largest = 0.0;
  for (int k = 0; k <= samples.back(); ++k) {
    largest = std::max(largest, (correction.at(k * kSample) - f(k) * kAlong).norm());
  }
  return largest;
}

double parabola(double sample) {
  return 1e-3 * sample * sample;
}

// A chord of the parabola a x^2 over h is off by a h^2 / 4 in the middle.
TEST(InterpolationError, OfAParabolaIsThatOfTheChordOverTheLongerInterval) {
  for (const int knot : {1, 2, 5, 10, 13, 18, 19}) {
    const double longer = std::max(knot, 20 - knot);
    EXPECT_NEAR(stated({knot, 20}, parabola), 0.25e-3 * longer * longer, 1e-15) << knot;
    EXPECT_LE(found({knot, 20}, parabola), stated({knot, 20}, parabola)) << knot;
  }
}

// It is an estimate, no bound: too small for curves that bend most where they begin,
// too large for those that bend at their end, where knots are left out.
TEST(InterpolationError, OfPowersIsAFifthToFiveTimesWhatIsFoundBesideSmallSteps) {
  for (const std::vector<int>& samples :
       std::vector<std::vector<int>>{{8, 13, 17, 20},
                                     {6, 11, 15, 19, 20},
                                     {8, 9, 10, 17, 20},
                                     {8, 13, 14, 15, 16, 20},
                                     {8, 13, 14, 20},
                                     {8, 9, 17}}) {
    for (const double power : {1.5, 2.0, 2.5, 3.0, 4.0}) {
      const auto curve = [&](double sample) {
        return 0.1 * std::pow(sample / samples.back(), power);
      };
      const double over_found = stated(samples, curve) / found(samples, curve);
      EXPECT_GT(over_found, 0.2) << samples[1] << ", power " << power;
      EXPECT_LT(over_found, 5.1) << samples[1] << ", power " << power;
    }
  }
}

TEST(InterpolationError, OfEverySampleAndOfAStraightLineIsNone) {
  EXPECT_EQ(stated({1, 2, 3, 4, 5}, parabola), 0.0);
  EXPECT_EQ(stated({7}, parabola), 0.0);
  EXPECT_NEAR(stated({3, 8, 20},
                     [](double sample) {
                       return 0.01 * sample;
                     }),
              0.0, 1e-15);
}

// The force 5 samples deep is a hundredth of the last, and counts as a tenth of it.
TEST(InterpolationError, CountsSmallForcesAsATenthOfTheLargest) {
  const auto force_n = [](double sample) {
    return sample < 20 ? 0.01 : 1.0;
  };
  const Function ends_at_none = [](double sample) {
    return 1e-3 * sample * (20.0 - sample);
  };
  const double small =
      interpolation_error(path_to(20, force_n), knots_at({5, 20}, ends_at_none));
  EXPECT_NEAR(small, 0.1 * stated({5, 20}, ends_at_none), 1e-15);
}

}  // namespace
}  // namespace palpate
