#include "tests/bench/runtime/bench_edges.h"

#include <gtest/gtest.h>

#include "tests/bench/runtime/bench_slide.h"

namespace palpate {
namespace {

// A sphere of 0.1 m across and of one response, whose edges turn by some degrees:
// forces turn by as much on facets, and with the place alone in the smooth field, 1 um
// of 50 mm.
TEST(EdgesBench, FacetsStepByTheirAnglesAndTheSmoothFieldDoesNot) {
  const ResponseDatabase body = slide_body(968, 0.005, 0.0);
  const std::vector<EdgesBenchRow> rows = run_edges_bench(body, body.tools.front());
  ASSERT_EQ(rows.size(), 6U);
  for (const EdgesBenchRow& row : rows) {
    EXPECT_GT(row.edges, 1000) << name(row.model);
    if (row.model == LocalModel::kFacets) {
      EXPECT_GT(row.median, 0.01);
      EXPECT_GT(row.turn_largest_rad, 0.05);
    } else {
      EXPECT_LT(row.largest, 2e-4) << row.depth_m;
      EXPECT_LT(row.turn_largest_rad, 2e-4) << row.depth_m;
    }
  }
}

}  // namespace
}  // namespace palpate
