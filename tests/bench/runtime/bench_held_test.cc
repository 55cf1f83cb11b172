#include "tests/bench/runtime/bench_held.h"

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/bench/runtime/bench_slide.h"

namespace palpate {
namespace {

// A sphere, or a hollow one: felt from inside.
ResponseDatabase ball(bool hollow) {
  ResponseDatabase body = slide_body(968, 0.005, 0.0);
  if (hollow) {
    body.normal *= -1.0;
    body.body.triangle.col(0).swap(body.body.triangle.col(1));
    body.tools.front().direction *= -1.0;
  }
  return body;
}

TEST(HeldBench, NoPassiveModelGivesMoreThanItsStiffnessButFacetsInAHollow) {
  for (const bool hollow : {false, true}) {
    const ResponseDatabase body = ball(hollow);
    const std::vector<HeldBenchRow> rows =
        run_held_bench(body, body.tools.front(), {.edges = 25});
    ASSERT_EQ(rows.size(), 45U);
    for (const HeldBenchRow& row : rows) {
      EXPECT_GE(row.edges, 20) << name(row.model);
      const bool relay = hollow && row.model == LocalModel::kFacets &&
                         row.way == HeldWay::kAcross && row.step_m < 5e-5;
      if (relay) {
        EXPECT_GT(row.given, 5.0) << row.step_m;
      } else if (row.model != LocalModel::kFacets) {
        EXPECT_LE(row.given, 1.0 + 1e-6) << name(row.model) << " " << row.step_m;
        // A linear spring along the normal gives all of it.
        EXPECT_NEAR(row.given, row.way == HeldWay::kNormal ? 1.0 : 0.5, 0.5);
      }
      if (row.model == LocalModel::kPotential || row.model == LocalModel::kElement) {
        EXPECT_LE(row.tick, 1.001) << row.step_m;
        if (row.way == HeldWay::kNormal) {
          EXPECT_GT(row.given, 0.99) << row.step_m;
        }
      }
    }
  }
}

TEST(HeldBench, RefusesWhatIsNoDepth) {
  const ResponseDatabase body = ball(false);
  EXPECT_THROW((void)run_held_bench(body, body.tools.front(), {.depth_share = 1.5}),
               InputError);
}

}  // namespace
}  // namespace palpate
