#include "formats/database/precision_choice.h"

#include <gtest/gtest.h>

#include "tests/support/small_database.h"
#include "tests/support/sphere_database.h"

namespace palpate {
namespace {

TEST(PrecisionBench, OnlyRoundingDiffersAndEveryWayIsMeasured) {
  const std::vector<PrecisionRow> rows = measure_precisions(sphere_database(8, 9));
  ASSERT_EQ(rows.size(), 6u);
  for (const PrecisionRow& row : rows) {
    ASSERT_TRUE(row.possible);
    EXPECT_GT(row.bytes, 0u);
    switch (row.storage.precision) {
      case Precision::kFloat64:
        EXPECT_EQ(row.force.largest, 0.0);
        EXPECT_EQ(row.energy.largest, 0.0);
        break;
      case Precision::kFloat32:  // a depth error of 2^-25 at a slope of 1.5 f/d
        EXPECT_LT(row.force.largest, 3.0 * 0x1p-24);
        break;
      case Precision::kInt16:  // half a step of force, and of depth at that slope
        EXPECT_LT(row.force.largest, 3.0 / 32767);
        EXPECT_GT(row.force.largest, 0.1 / 32767);
        break;
    }
  }
  EXPECT_LT(rows[4].bytes, rows[2].bytes);  // int16 is smaller than float32
  EXPECT_LT(rows[2].bytes, rows[0].bytes);  // float32 than float64
}

TEST(PrecisionBench, TheCheapestPrecisionIsUnderATenthOfTheBudget) {
  const ResponseDatabase database = sphere_database(8, 9);
  EXPECT_EQ(cheapest_precision(database, 0.05), Precision::kInt16);
  EXPECT_EQ(cheapest_precision(database, 1e-5), Precision::kFloat32);
  EXPECT_EQ(cheapest_precision(database, 1e-9), Precision::kFloat64);
}

TEST(PrecisionBench, TheChoiceFollowsTheStrictestBudgetUnlessOneIsAskedFor) {
  ResponseDatabase database = small_database();
  EXPECT_EQ(budget_relative(sphere_database(3, 5)), 0.07);  // states none
  for (ResponseTable& table : database.tools) {
    table.accuracy.budget_relative = 0.05;
  }
  choose_precision(database, std::nullopt);
  EXPECT_EQ(database.storage.precision, Precision::kInt16);
  database.tools.back().accuracy.budget_relative = 1e-5;
  EXPECT_EQ(budget_relative(database), 1e-5);
  choose_precision(database, std::nullopt);
  EXPECT_EQ(database.storage.precision, Precision::kFloat32);
  choose_precision(database, Precision::kFloat64);
  EXPECT_EQ(database.storage.precision, Precision::kFloat64);
}

}  // namespace
}  // namespace palpate
