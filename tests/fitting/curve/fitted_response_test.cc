#include "fitting/curve/fitted_response.h"

#include <fstream>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/response/response_curve.h"
#include "tests/support/synthetic_curve.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

ContactFit fit(const SyntheticCurve& curve) {
  return fit_contact(select_approach(synthetic(curve, 1)));
}

TEST(FittedResponse, StoredCubicStaysOnThePowerLaw) {
  for (const double exponent : {1.0, 1.5, 2.5, 4.0}) {
    const ContactFit law = fit({.exponent = exponent});
    const NodeResponse response = fitted_response(law, Eigen::Vector3d::UnitZ());
    const ResponseCurve curve(response.depth_m, response.force_n);
    const double largest = response.force_n.back();
    EXPECT_DOUBLE_EQ(curve.depth_max_m(), law.depth_max_m);
    for (int i = 0; i <= 1000; ++i) {
      const double d = law.depth_max_m * i / 1000;
      EXPECT_NEAR(curve.at(d).force_n, contact_force_n(law, d), 1e-4 * largest);
    }
    EXPECT_EQ(response.origin, ResponseOrigin::kMeasured);
    EXPECT_DOUBLE_EQ(response.error_relative, law.rms_n / largest);
  }
}

TEST(FittedResponse, ThereIsNoneOfAnEmptyRun) {
  ContactFit empty;
  empty.flags = {FitFlag::kEmptyRun};
  EXPECT_THROW((void)fitted_response(empty, Eigen::Vector3d::UnitZ()), NumericalError);
}

TEST(SamplePatch, IsAValidDatabaseThatSurvivesItsFile) {
  const ScratchFolder folder;
  std::ofstream(folder / "curve.csv") << "x,f\n";
  const Measurement measured = synthetic({}, 1);
  const ContactFit law = fit({});
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
    EXPECT_NEAR(table.curve(node).at(3e-3).force_n, contact_force_n(law, 3e-3), 1e-4);
  }
}

TEST(SamplePatch, NeedsAToolThatCanBeRendered) {
  EXPECT_THROW((void)sample_patch(fit({}), {}, {"probe", "sphere", -1.0, 0.0, 0.0}, ""),
               InputError);
}

}  // namespace
}  // namespace palpate
