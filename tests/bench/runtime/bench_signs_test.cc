#include "tests/bench/runtime/bench_signs.h"

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/bench/runtime/bench_slide.h"

namespace palpate {
namespace {

TEST(SignsBench, NothingPullsAndNoEnergyIsNegative) {
  for (const double discord : {0.0, 0.7, 2.3}) {
    const SignsBenchReport report = run_signs_bench(
        slide_body(968, 0.005, 0.0), "", {.places = 200'000, .discord = discord});
    EXPECT_GT(report.places, 100'000);
    EXPECT_EQ(report.negative, 0);
    EXPECT_EQ(report.pulls, 0) << report.worst_pull_n;
    EXPECT_EQ(report.unsound, 0);
  }
}

TEST(SignsBench, NothingPullsInDatabasesOfChance) {
  const SignsBenchReport report =
      run_signs_bench(slide_body(72, 0.005, 0.0), "",
                      {.places = 200'000, .discord = 1.0, .databases = 200});
  EXPECT_GT(report.places, 100'000);
  EXPECT_EQ(report.negative, 0) << report.lowest_j;
  EXPECT_EQ(report.pulls, 0) << report.worst_pull_n;
  EXPECT_EQ(report.unsound, 0);
}

// Curves that pull are found, so that a hunt that finds none says something.
TEST(SignsBench, FindsWhatPulls) {
  ResponseDatabase body = slide_body(200, 0.005, 0.0);
  for (double& force_n : body.tools.front().force_n) {
    force_n *= -1.0;
  }
  for (double& energy_j : body.tools.front().energy_j) {
    energy_j *= -1.0;
  }
  for (double& slope : body.tools.front().stiffness_n_per_m) {
    slope *= -1.0;
  }
  const SignsBenchReport report = run_signs_bench(body, "", {.places = 10'000});
  EXPECT_GT(report.places, 5000);
  EXPECT_EQ(report.negative, report.places);
  EXPECT_GT(report.pulls, report.places / 2);
}

TEST(SignsBench, RefusesNoPlaces) {
  EXPECT_THROW((void)run_signs_bench(slide_body(200, 0.005, 0.0), "", {.places = 0}),
               InputError);
}

}  // namespace
}  // namespace palpate
