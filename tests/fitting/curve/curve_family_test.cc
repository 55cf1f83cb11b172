#include "fitting/curve/curve_family.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

struct FamilyCase {
  std::shared_ptr<const CurveFamily> family;
  std::vector<double> q;
};

std::vector<FamilyCase> families() {
  std::vector<FamilyCase> all = {
      {quadratic_linear_family(), {1.3, 0.4}},
      {power_law_family(), {0.9, 1.7}},
      {linear_exponential_family(), {0.3, 0.7, 0.2}},
      {polynomial_family(), {0.1, 0.2, 0.3, 0.4}},
      {convex_spline_family(5), {0.1, 2, 0, 1, 3, 0.5}},
      {cubic_family("monotone-cubic", {0.2, 0.5, 1.0}), {0.1, 0.4, 1.0}},
      {cubic_family("interpolating", {0.2, 0.5, 1.0}), {0.4, 0.1, 1.0}}};
  return all;
}

// Laws that every family obeys; central differences over 1e-6 are good to 1e-8.
TEST(CurveFamily, SlopeAndForceAreDerivativesOfForceAndEnergy) {
  for (const FamilyCase& c : families()) {
    for (const double d : {0.013, 0.31, 0.47, 0.93, 1.2}) {
      const double h = 1e-6;
      const FamilyPoint below = c.family->at(c.q, d - h),
                        above = c.family->at(c.q, d + h);
      const FamilyPoint here = c.family->at(c.q, d);
      EXPECT_NEAR((above.force - below.force) / (2 * h), here.slope, 1e-7)
          << c.family->name() << d;
      EXPECT_NEAR((above.energy - below.energy) / (2 * h), here.force, 1e-7)
          << c.family->name() << d;
    }
  }
}

TEST(CurveFamily, IsNothingBeforeContact) {
  for (const FamilyCase& c : families()) {
    for (const double d : {0.0, -0.2}) {
      EXPECT_EQ(c.family->at(c.q, d).force, 0.0);
      EXPECT_EQ(c.family->at(c.q, d).energy, 0.0);
    }
  }
}

TEST(CurveFamily, RisesAndIsConvexUnlessItIsACubicThroughPoints) {
  for (const FamilyCase& c : families()) {
    if (c.family->name() == "interpolating") {
      continue;
    }
    double slope = 0.0;
    for (int i = 1; i <= 200; ++i) {
      const FamilyPoint p = c.family->at(c.q, 0.006 * i);
      EXPECT_GE(p.slope, 0.0);
      if (c.family->name() != "monotone-cubic") {
        EXPECT_GE(p.slope, slope - 1e-12) << c.family->name();
      }
      slope = p.slope;
    }
  }
}

// Depths at which the cubic's sum rounds below 0.
TEST(CurveFamily, ACubicThroughForcesIsNowhereNegative) {
  for (int i = 1; i < 500; ++i) {
    const double peak = 0.37 + 0.01 * i, end = 1.0 - 1e-3 * i;
    const auto family =
        cubic_family("interpolating", {0.3 * end, 0.7 * end, 0.9 * end, end});
    const std::vector<double> q{0.1, peak, 0.5 * peak, 0.0};
    EXPECT_GE(family->at(q, end).force, 0.0);
    EXPECT_GE(family->at(q, 1.1 * end).force, 0.0);
  }
}

TEST(CurveFamily, GradientIsTheDerivativeByTheParameters) {
  for (const FamilyCase& c : families()) {
    if (c.family->name() == "monotone-cubic" || c.family->name() == "interpolating") {
      continue;  // the polygon's, by contract
    }
    for (const double d : {0.0, 0.31, 0.47, 0.93}) {
      std::vector<double> row(c.q.size());
      c.family->gradient(c.q, d, row);
      for (std::size_t j = 0; j < c.q.size(); ++j) {
        const double h = 1e-6;
        std::vector<double> less = c.q, more = c.q;
        less[j] -= h;
        more[j] += h;
        EXPECT_NEAR(
            (c.family->at(more, d).force - c.family->at(less, d).force) / (2 * h),
            row[j], 1e-8 * std::max(1.0, std::abs(row[j])))
            << c.family->name() << " parameter " << j << " at " << d;
      }
    }
  }
}

TEST(CurveFamily, QuadraticLinearIsSmoothWhereItsPartsMeet) {
  const auto family = quadratic_linear_family();
  const std::vector<double> q{2.0, 0.5};
  EXPECT_DOUBLE_EQ(family->at(q, 0.5).force, 0.5);
  EXPECT_NEAR(family->at(q, 0.5 + 1e-12).force, 0.5, 1e-11);
  EXPECT_NEAR(family->at(q, 0.5 + 1e-12).slope, family->at(q, 0.5).slope, 1e-11);
  EXPECT_DOUBLE_EQ(family->at(q, 1.5).force - family->at(q, 1.0).force, 1.0);
}

TEST(CurveFamily, ConvexSplineHoldsACubicExactly) {
  const auto family = convex_spline_family(4);
  // f = d + d^2 + d^3: slope 1 at 0, curvature 2 + 6 d at the knots 0, 1/3, 2/3, 1.
  const std::vector<double> q{1, 2, 4, 6, 8};
  for (const double d : {0.1, 0.5, 0.9, 1.0}) {
    EXPECT_NEAR(family->at(q, d).force, d + d * d + d * d * d, 1e-14);
  }
}

TEST(CurveFamily, EveryNameHasOneAndAnotherNameHasNone) {
  for (const std::string_view name : kFamilyNames) {
    const auto family = family_by_name(name);
    if (name != "monotone-cubic" && name != "interpolating") {
      EXPECT_EQ(family->name(), name);
    }
  }
  EXPECT_THROW((void)family_by_name("spline"), InputError);
}

}  // namespace
}  // namespace palpate
