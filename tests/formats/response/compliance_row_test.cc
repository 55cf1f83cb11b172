// What a row of compliances over distance means, between, beyond and below its knots.
#include "formats/response/compliance_row.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "formats/response/compliance_table.h"

namespace palpate {
namespace {

// Six distances, each twice the one before.
constexpr double kFirstM = 0.002;
const ComplianceKnots kKnots{kFirstM, std::numbers::ln2, 6};
const std::vector<double> kUneven{3e-6, 2e-6, 2.5e-6, 1e-6, -4e-7, 1e-7};

TEST(ComplianceRow, LogarithmIsRightToTheLastDigits) {
  for (int i = 0; i < 20'000; ++i) {
    const double x = std::exp2(-30.0 + 0.00317 * i);  // both sides of each power of two
    const auto exact = static_cast<double>(std::log(static_cast<long double>(x)));
    EXPECT_NEAR(arithmetic_log(x), exact, std::max(4.5e-16 * std::abs(exact), 1e-16))
        << x;
  }
  EXPECT_EQ(arithmetic_log(1.0), 0.0);
  EXPECT_EQ(arithmetic_log(std::numeric_limits<double>::infinity()),
            std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(arithmetic_log(std::nan(""))));
}

TEST(ComplianceRow, IsTheNumberOverTheDistanceAtAKnot) {
  for (std::size_t k = 0; k < kKnots.count; ++k) {
    const double r = kFirstM * std::exp2(static_cast<double>(k));
    EXPECT_NEAR(compliance_at(kKnots, kUneven, r).compliance_m_per_n * r, kUneven[k],
                1e-19);
  }
}

TEST(ComplianceRow, HalfSpaceFallsAsOneOverDistance) {
  const std::vector<double> half_space(6, 1e-6);
  for (const double r : {0.002, 0.0031, 0.0171, 0.063, 0.064, 0.5}) {
    const ComplianceSample c = compliance_at(kKnots, half_space, r);
    EXPECT_NEAR(c.compliance_m_per_n, 1e-6 / r, 1e-15 / r);
    EXPECT_NEAR(c.slope_per_n, -1e-6 / (r * r), 1e-15 / (r * r));
  }
}

TEST(ComplianceRow, OfAHalfSpaceEndsAtOneAndAHalfTimesTheFirstWhereContactsCoincide) {
  const std::vector<double> half_space(6, 1e-6);
  const ComplianceSample c = compliance_at(kKnots, half_space, 0.0);
  EXPECT_NEAR(c.compliance_m_per_n, 1.5e-6 / kFirstM, 1e-15);
  EXPECT_EQ(c.slope_per_n, 0.0);
}

TEST(ComplianceRow, CubicsInTheLogarithmOfDistanceAreExactBetweenInnerKnots) {
  // Slopes that are means of two secants are those of any quadratic.
  const auto v = [](double step) {
    return 1e-6 * (2.0 - 0.3 * step - 0.1 * step * step);
  };
  std::vector<double> row;
  for (int k = 0; k < 6; ++k) {
    row.push_back(v(k));
  }
  for (const double step : {1.0, 1.3, 2.5, 3.9}) {
    const double r = kFirstM * std::exp2(step);
    EXPECT_NEAR(compliance_at(kKnots, row, r).compliance_m_per_n * r, v(step), 1e-18);
  }
}

TEST(ComplianceRow, SlopeIsTheDerivative) {
  for (const double r :
       {1e-4, 0.0013, 0.0021, 0.0055, 0.011, 0.02, 0.05, 0.0639, 0.2}) {
    const double h = 1e-6 * r;
    const double change = compliance_at(kKnots, kUneven, r + h).compliance_m_per_n -
                          compliance_at(kKnots, kUneven, r - h).compliance_m_per_n;
    const double slope = compliance_at(kKnots, kUneven, r).slope_per_n;
    // Rounding of c over the step: 1e-16 c / h is 1e-10 c / r.
    EXPECT_NEAR(change / (2.0 * h), slope, 1e-8 * (3e-6 / (r * r))) << r;
  }
}

TEST(ComplianceRow, ValueAndSlopeAreContinuous) {
  for (std::size_t k = 0; k < kKnots.count; ++k) {
    const double r = kFirstM * std::exp2(static_cast<double>(k));
    const ComplianceSample before = compliance_at(kKnots, kUneven, r * (1.0 - 1e-12));
    const ComplianceSample after = compliance_at(kKnots, kUneven, r * (1.0 + 1e-12));
    EXPECT_NEAR(before.compliance_m_per_n, after.compliance_m_per_n, 1e-10 * 3e-6 / r);
    EXPECT_NEAR(before.slope_per_n, after.slope_per_n, 1e-10 * 3e-6 / (r * r));
  }
}

TEST(ComplianceRow, IsLinearInTheRow) {
  const std::vector<double> other{1e-6, 5e-6, 0.0, -1e-6, 2e-6, 3e-6};
  std::vector<double> blend;
  for (std::size_t k = 0; k < other.size(); ++k) {
    blend.push_back(0.3 * kUneven[k] + 0.7 * other[k]);
  }
  for (const double r : {0.0, 0.001, 0.003, 0.07}) {
    EXPECT_NEAR(compliance_at(kKnots, blend, r).compliance_m_per_n,
                0.3 * compliance_at(kKnots, kUneven, r).compliance_m_per_n +
                    0.7 * compliance_at(kKnots, other, r).compliance_m_per_n,
                1e-17);
  }
}

TEST(ComplianceRow, NotANumberStaysOne) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(compliance_at(kKnots, kUneven, nan).compliance_m_per_n));
  EXPECT_EQ(compliance_at(kKnots, kUneven, std::numeric_limits<double>::infinity())
                .compliance_m_per_n,
            0.0);
}

TEST(ComplianceTable, PlacesInATriangleHaveTheNodesRowsByArea) {
  ComplianceTable table;
  table.distance_m = log_spaced(kFirstM, 32.0 * kFirstM, 6);
  table.value = RowsOf<float>::Random(4, 6);
  const ComplianceKnots knots = knots_of(table);
  EXPECT_EQ(knots.count, 6U);
  EXPECT_NEAR(knots.log_step, std::numbers::ln2, 1e-15);
  const std::vector<std::int32_t> corner{3, 0, 2};
  const std::vector<double> weights{0.2, 0.5, 0.3};
  const ComplianceRow row = contact_compliance(table, corner, weights);
  for (Eigen::Index k = 0; k < 6; ++k) {
    const auto v = [&](Eigen::Index i) {
      return static_cast<double>(table.value(i, k));
    };
    EXPECT_NEAR(row[static_cast<std::size_t>(k)], 0.2 * v(3) + 0.5 * v(0) + 0.3 * v(2),
                1e-15);
  }
  const ComplianceRow other =
      contact_compliance(table, corner, std::vector{1.0, 0.0, 0.0});
  EXPECT_NEAR(coupling(knots, row, other, 0.01).compliance_m_per_n,
              0.5 * (compliance_at(knots, row, 0.01).compliance_m_per_n +
                     compliance_at(knots, other, 0.01).compliance_m_per_n),
              1e-15);
  EXPECT_EQ(coupling(knots, row, other, 0.01).slope_per_n,
            coupling(knots, other, row, 0.01).slope_per_n);
}

}  // namespace
}  // namespace palpate
