#include "runtime/bench/bench_walk.h"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

// A ball whose nodes differ ninefold, to 6 mm.
ResponseDatabase body() {
  return sample_database(
      sphere_surface(0.05, 3), ball(0.005, 0.3, 5e-4),
      [](Eigen::Index node, double d) {
        return static_cast<double>(node % 9 + 1) * 500.0 * std::pow(d, 1.5);
      },
      0.006);
}

TEST(WalkBench, SurfaceModelsCreateNoEnergyUnderEverythingAtOnce) {
  const ResponseDatabase database = body();
  for (const LocalModel model : {LocalModel::kElement, LocalModel::kPotential}) {
    const WalkBenchReport r = run_walk(database, {.model = model, .ticks = 300'000});
    EXPECT_EQ(r.fault, Fault::kNone) << name(model);
    EXPECT_EQ(r.ticks, 300'000) << name(model);
    EXPECT_EQ(r.not_finite, 0) << name(model);
    // 3e5 sums of energies below 1e-2 J, each rounded at 1e-18 J.
    EXPECT_LT(r.created_j, 1e-11) << name(model);
    EXPECT_LT(r.drift_j, 1e-11) << name(model);
    EXPECT_GT(r.contact_ticks, 50'000) << name(model);
    EXPECT_GT(r.starved_ticks, 0) << name(model);
    EXPECT_GT(r.force_max_n, 0.1) << name(model);
    // The stiffest node gives 2.1 N at 6 mm, friction as much again; an element that
    // is carried on beyond its edges is deeper.
    EXPECT_LT(r.force_max_n, 20.0) << name(model);
  }
}

TEST(WalkBench, TheSameSeedGivesTheSameWalk) {
  const ResponseDatabase database = body();
  const WalkBenchReport a = run_walk(database, {.ticks = 5000});
  const WalkBenchReport b = run_walk(database, {.ticks = 5000});
  EXPECT_EQ(a.work_j, b.work_j);
  EXPECT_NE(a.work_j, run_walk(database, {.ticks = 5000, .seed = 2}).work_j);
}

TEST(WalkBench, RefusesSharesThatAreNone) {
  EXPECT_THROW((void)run_walk(body(), {.starvation = std::nan("")}), InputError);
  EXPECT_THROW((void)run_walk(body(), {.ticks = 0}), InputError);
}

TEST(WalkBench, ReportHasItsKeys) {
  const auto json = parse_json(to_json(WalkBenchReport{}));
  for (const char* key :
       {"ticks", "created_j", "drift_j", "force_max_n", "not_finite"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
}

}  // namespace
}  // namespace palpate
