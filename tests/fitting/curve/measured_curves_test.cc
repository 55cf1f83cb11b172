// What the fit says about curves that laboratories measured.
#include <filesystem>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "fitting/curve/power_law_fit.h"
#include "formats/measurement/measurement_file.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

using std::filesystem::directory_iterator;

TEST(MeasuredCurves, SiliconesHaveTheirPublishedSlopesAtSmallStrain) {
  const auto folder = test_data("tissue_phantom_compression");
  if (!folder) {
    GTEST_SKIP() << "no test data";
  }
  const double height_m = 0.03, area_m2 = std::numbers::pi * 0.025 * 0.025;
  const std::pair<const char*, double> materials[] = {
      {"EF10_0T", 62.1e3}, {"EF10_50T", 16.9e3}, {"EF30_25T", 55.4e3}};
  for (const auto& [material, slope_pa] : materials) {
    double sum = 0.0;
    int repeats = 0;
    for (const auto& file : directory_iterator(*folder / material)) {
      const auto read = read_measurement(file, {"Compression", "mm"}, {"Load", "N"});
      const FitRange strain_1_to_10_percent{0.01 * height_m, 0.1 * height_m};
      const auto fit =
          fit_contact(select_approach(read.samples, strain_1_to_10_percent));
      sum += fit.mean_stiffness_n_per_m * height_m / area_m2;
      ++repeats;
    }
    ASSERT_EQ(repeats, 10);
    // Slopes of ten repeats whose forces scatter by 2 to 3 %: their mean to 1 %.
    EXPECT_NEAR(sum / repeats, slope_pa, 0.01 * slope_pa) << material;
  }
}

TEST(MeasuredCurves, PorkIsInContactFromTheStartAndThenHeld) {
  const auto folder = test_data("pork_indent_relax");
  if (!folder) {
    GTEST_SKIP() << "no test data";
  }
  int curves = 0;
  for (const auto& file : directory_iterator(*folder)) {
    if (file.path().extension() != ".csv") {
      continue;
    }
    const auto read = read_measurement(file, {"displacement", "mm"}, {"force", "N"});
    const auto fit = fit_contact(select_approach(read.samples));
    EXPECT_TRUE(fit.converged) << file.path();
    EXPECT_TRUE(fit.has(FitFlag::kAlreadyInContact)) << file.path();
    EXPECT_TRUE(fit.has(FitFlag::kContactPointNotIdentified)) << file.path();
    EXPECT_TRUE(fit.has(FitFlag::kHoldCutOff)) << file.path();
    EXPECT_FALSE(fit.has(FitFlag::kSpikes)) << file.path();
    ++curves;
  }
  EXPECT_EQ(curves, 24);
}

TEST(MeasuredCurves, SpringLoopsAreNotPassiveAndAsStiffAsTheirSprings) {
  const auto folder = test_data("springs_loop");
  if (!folder) {
    GTEST_SKIP() << "no test data";
  }
  const std::pair<const char*, double> springs[] = {
      {"Cherry-MX-Clear-slow-vs-fast__MX_Clear_just_spring.csv", 130.0},
      {"Cherry-MX-Clear-slow-vs-fast__Kailh_Speed_Pale_Blue_just_spring.csv", 96.0},
      {"KTT-Kang-White-spring__Raw_data.csv", 69.0}};
  for (const auto& [name, stiffness] : springs) {
    const auto read =
        read_measurement(*folder / name, {"travel", "um"}, {"force", "gf"});
    // Between the preload's step and 3.2 mm, beyond which coils begin to close.
    const auto approach = select_approach(read.samples, {0.5e-3, 3.2e-3});
    const auto fit = fit_contact(approach);
    EXPECT_TRUE(fit.has(FitFlag::kNonPassiveLoop)) << name;
    EXPECT_TRUE(fit.has(FitFlag::kRetractCutOff)) << name;
    const double excess = approach.release_work_j / approach.press_work_j - 1.0;
    EXPECT_GT(excess, 0.004) << name;
    EXPECT_LT(excess, 0.010) << name;
    EXPECT_NEAR(fit.mean_stiffness_n_per_m, stiffness, 0.01 * stiffness) << name;
    // No spring is linear up to its end stop: the last millimetre is 7 to 20 % stiffer,
    // so that a range which takes it in gives a line 2 to 4 % too steep.
    const auto end = fit_contact(select_approach(read.samples, {3.0e-3, 3.8e-3}));
    EXPECT_GT(end.mean_stiffness_n_per_m, 1.05 * stiffness) << name;
  }
}

}  // namespace
}  // namespace palpate
