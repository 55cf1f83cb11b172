#include "tests/bench/runtime/bench_search.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"

namespace palpate {
namespace {

TEST(SearchBench, MeasuresEverySizeThatWasAskedFor) {
  const std::vector<SearchBenchRow> rows =
      run_search_bench({.triangles = {2, 5000}, .queries = 200});
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].triangles, 2);
  EXPECT_GE(rows[1].triangles, 5000);
  for (const SearchBenchRow& row : rows) {
    EXPECT_GE(row.first_p999_ns, row.first_median_ns);
    EXPECT_GE(row.slide_p999_ns, row.slide_median_ns);
    EXPECT_GE(row.press_p999_ns, row.press_median_ns);
  }
  EXPECT_GT(rows[1].first_median_ns, 0.0);
  EXPECT_EQ(parse_json(to_json(rows)).at("rows").size(), 2U);
}

TEST(SearchBench, RefusesSurfacesThatAreNone) {
  EXPECT_THROW((void)run_search_bench({.triangles = {1}, .queries = 1}), InputError);
  EXPECT_THROW((void)run_search_bench({.triangles = {2}, .queries = 0}), InputError);
}

}  // namespace
}  // namespace palpate
