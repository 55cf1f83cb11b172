#include "tests/bench/runtime/bench_potential.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"

namespace palpate {
namespace {

// Computed once: three models, 20000 ticks, below 1 s.
const PotentialBenchReport& potential_report() {
  static const PotentialBenchReport kReport = [] {
    PotentialBenchOptions options;
    options.ticks = 20000;
    options.contrasts = {100.0};
    options.frictions = {0.0, 1.0};
    return run_potential_bench(options);
  }();
  return kReport;
}

TEST(PotentialBench, TheFieldNeedsNoLedgerAndRendersTheCurve) {
  int rows = 0;
  for (const PotentialBenchRow& row : potential_report().rows) {
    EXPECT_GT(row.contact_ticks, 1000);
    EXPECT_LE(row.created_j, 1e-12) << name(row.model);
    if (is_field(row.model)) {
      EXPECT_EQ(row.interventions, 0U) << row.friction;
      EXPECT_LE(row.normal_error_max, 1e-9) << row.friction;
      ++rows;
    }
  }
  EXPECT_EQ(rows, 4);
}

TEST(PotentialBench, TheElementModelPaysForItsDirections) {
  for (const PotentialBenchRow& row : potential_report().rows) {
    if (row.model == LocalModel::kElement && row.friction == 0.0) {
      EXPECT_GT(row.interventions, 100U);
      EXPECT_GT(row.normal_error_rms, 0.05);
    }
  }
}

TEST(PotentialBench, ReportHasItsKeys) {
  const auto json = parse_json(to_json(potential_report()));
  ASSERT_EQ(json["rows"].size(), 6U);
  for (const char* key : {"body", "contrast", "friction", "model", "interventions",
                          "energy_created_j", "normal_error_max"}) {
    EXPECT_TRUE(json["rows"][0].contains(key)) << key;
  }
}

}  // namespace
}  // namespace palpate
