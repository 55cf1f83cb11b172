#include "fitting/curve/fitted_response.h"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/response/response_curve.h"
#include "tests/support/synthetic_curve.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

FamilyFit fit_family(const Measurement& m, const std::string& family = "power-law") {
  const Approach approach = select_approach(m);
  return fit_families(approach, fit_contact(approach), {family}, "aicc").fits.front();
}
FamilyFit fit_family(const SyntheticCurve& curve) {
  return fit_family(synthetic(curve, 1));
}

TEST(FittedResponse, StoredCubicStaysOnThePowerLaw) {
  for (const double exponent : {1.0, 1.5, 2.5, 4.0}) {
    const FamilyFit law = fit_family({.exponent = exponent});
    const NodeResponse response = fitted_response(law, Eigen::Vector3d::UnitZ());
    const ResponseCurve curve(response.depth_m, response.force_n);
    const double largest = response.force_n.back();
    EXPECT_DOUBLE_EQ(curve.depth_max_m(), law.depth_max_m);
    for (int i = 0; i <= 1000; ++i) {
      const double d = law.depth_max_m * i / 1000;
      EXPECT_NEAR(curve.at(d).force_n, family_point(law, d).force, 1e-4 * largest);
    }
    EXPECT_EQ(response.origin, ResponseOrigin::kMeasured);
  }
}

TEST(FittedResponse, CubicsAreStoredAtTheirKnots) {
  Measurement m = synthetic({}, 3);
  for (std::size_t i = 0; i < m.force_n.size(); ++i) {  // a plateau
    const double d = std::max(0.0, m.depth_m[i] - 2e-3) / kSyntheticDepth;
    m.force_n[i] += std::min(2.0 * d, 1.0) - std::pow(d, 1.5);
  }
  const FamilyFit law = fit_family(m, "monotone-cubic");
  const NodeResponse response = fitted_response(law, Eigen::Vector3d::UnitZ());
  const ResponseCurve curve(response.depth_m, response.force_n);
  for (int i = 0; i <= 1000; ++i) {
    const double d = law.depth_max_m * i / 1000;
    EXPECT_NEAR(curve.at(d).force_n, family_point(law, d).force, 2e-3);
  }
}

// The stated error holds the true one, at every depth from a tenth on, in 95 % of runs.
TEST(FittedResponse, StatedErrorsCoverTheTrueOnes) {
  constexpr unsigned kRuns = 100;
  int covered = 0;
  double stated = 0.0, true_ones = 0.0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const NodeResponse response =
        fitted_response(fit_family(synthetic({.noise_n = 0.01, .rho = 0.5}, seed)),
                        Eigen::Vector3d::UnitZ());
    const ResponseCurve curve(response.depth_m, response.force_n);
    double worst = 0.0;
    for (double share = 0.1; share <= 0.98; share += 0.02) {
      const double truth = std::pow(share, 1.5);
      worst =
          std::max(worst, std::abs(curve.at(share * kSyntheticDepth).force_n - truth) /
                              std::max(truth, 0.1));
    }
    covered += worst <= response.error_relative ? 1 : 0;
    stated += response.error_relative;
    true_ones += worst;
  }
  EXPECT_GE(covered, 88);  // 95 expected of independent runs, sd 2.2
  EXPECT_LT(stated, 4.0 * true_ones);
}

TEST(SamplePatch, IsAValidDatabaseThatSurvivesItsFile) {
  const ScratchFolder folder;
  std::ofstream(folder / "curve.csv") << "x,f\n";
  const Measurement measured = synthetic({}, 1);
  const FamilyFit law = fit_family(SyntheticCurve{});
  const ToolShape ball{"probe", "sphere", 0.01, 0.0, 0.0};
  const ResponseDatabase patch =
      sample_patch(law, measured, ball, folder / "curve.csv");
  EXPECT_NO_THROW(check(patch));
  EXPECT_DOUBLE_EQ(surface_area_m2(patch.body), 0.01);
  write_database(folder / "patch.h5", patch);
  const ResponseDatabase read = read_database(folder / "patch.h5");
  EXPECT_EQ(read.measurement.depth_m, measured.depth_m);
  EXPECT_EQ(read.measurement.force_n, measured.force_n);
  EXPECT_EQ(read.provenance.source_file, "curve.csv");
  const ResponseTable& table = find_tool(read, "probe");
  ASSERT_EQ(table.nodes(), 4);
  for (std::int64_t node = 0; node < 4; ++node) {
    EXPECT_EQ(table.direction.row(node), Eigen::RowVector3d::UnitZ());
    EXPECT_NEAR(table.curve(node).at(3e-3).force_n, family_point(law, 3e-3).force,
                1e-4);
  }
}

TEST(SamplePatch, IsRefusedWhereTheCurvesErrorIsNotKnown) {
  FamilyFit law = fit_family(SyntheticCurve{});
  law.covariance.setConstant(std::nan(""));
  try {
    (void)sample_patch(law, synthetic({}, 1), {"probe", "sphere", 0.01, 0.0, 0.0}, "");
    FAIL();
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("error is not known"), std::string::npos);
  }
}

TEST(SamplePatch, NeedsAToolThatCanBeRendered) {
  EXPECT_THROW((void)sample_patch(fit_family(SyntheticCurve{}), {},
                                  {"probe", "sphere", -1.0, 0.0, 0.0}, ""),
               InputError);
}

}  // namespace
}  // namespace palpate
