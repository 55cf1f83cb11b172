#include "tests/bench/runtime/bench_slide.h"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"

namespace palpate {
namespace {

TEST(SlideBench, WithoutFrictionClosedPathsCreateAndLoseNothing) {
  for (const SlideBenchRow& r :
       run_slide_bench({.triangles = {968}, .friction = {0.0}, .rounds = 1})) {
    EXPECT_EQ(r.triangles, 968);
    EXPECT_EQ(r.not_finite, 0);
    EXPECT_EQ(r.interventions, 0U);
    // Some thousand additions of energies of some mJ.
    EXPECT_LT(r.created_j, 1e-14);
    EXPECT_NEAR(r.net_j, 0.0, 1e-14);
    // 8 mJ and 0.5 mJ on the true sphere; the mesh lies at most 1 % of R, 0.5 mm,
    // inside.
    const double depth_m = r.path == "slide" ? 0.001 : 0.004;
    EXPECT_LT(r.stored_j, 500.0 * depth_m * depth_m * 1.05);
    EXPECT_GT(r.stored_j, 500.0 * std::pow(depth_m - 5e-4, 2.0));
  }
}

TEST(SlideBench, WithFrictionTheyLose) {
  for (const SlideBenchRow& r : run_slide_bench({.triangles = {968},
                                .tool_radius_m = {0.005},
                                .friction = {0.3},
                                .rounds = 1})) {
    EXPECT_LT(r.created_j, 1e-14) << r.path;
    EXPECT_GT(r.net_j, 1e-4) << r.path;
  }
}

TEST(SlideBench, ForceErrorFallsWithTheTriangles) {
  const auto error = [](std::int64_t triangles, LocalModel model) {
    return run_slide_bench({.triangles = {triangles},
                            .tool_radius_m = {0.001},
                            .friction = {0.0},
                            .model = model,
                            .rounds = 1})
        .front()
        .error;
  };
  const auto coarse = [&](LocalModel model) {
    return error(968, model);
  };
  const auto fine = [&](LocalModel model) {
    return error(4 * 968, model);
  };
  // Four times the triangles halve an edge: on facets its sagitta falls to a quarter,
  // the smooth body to an eighth at least.
  EXPECT_NEAR(std::log2(coarse(LocalModel::kFacets) / fine(LocalModel::kFacets)), 2.0,
              0.3);
  EXPECT_GT(std::log2(coarse(LocalModel::kPotential) / fine(LocalModel::kPotential)),
            2.9);
}

TEST(SlideBench, RefusesWhatItCannotMake) {
  EXPECT_THROW((void)run_slide_bench({.triangles = {4}}), InputError);
  EXPECT_THROW((void)run_slide_bench({.model = LocalModel::kSingle}), InputError);
  EXPECT_THROW((void)run_slide_bench({.rounds = 0}), InputError);
}

TEST(SlideBench, ReportHasItsKeys) {
  const auto json = parse_json(to_json(std::vector<SlideBenchRow>(1)));
  for (const char* key : {"triangles", "p50_ns", "p999_ns", "created_j", "felt_j",
                          "rms_relative_error"}) {
    EXPECT_TRUE(json["rows"][0].contains(key)) << key;
  }
}

}  // namespace
}  // namespace palpate
