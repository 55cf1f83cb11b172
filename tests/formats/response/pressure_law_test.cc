#include "formats/response/pressure_law.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kReducedPa = 8000.0;  // E*
constexpr double kPressRadiusM = 0.004;
constexpr double kPressDepthM = 0.003;

// f = 4/3 E* sqrt(R) d^1.5 at many depths, closer together near 0.
NodeResponse hertz_press(const Eigen::Vector3d& direction) {
  NodeResponse response;
  response.direction = direction;
  response.origin = ResponseOrigin::kSimulated;
  for (int i = 0; i <= 200; ++i) {
    const double depth_m = kPressDepthM * i * i / 40000.0;
    response.depth_m.push_back(depth_m);
    response.force_n.push_back(4.0 / 3.0 * kReducedPa * std::sqrt(kPressRadiusM) *
                               std::pow(depth_m, 1.5));
  }
  return response;
}

ToolShape pressing_ball() {
  ToolShape tool;
  tool.name = "ball";
  tool.radius_m = kPressRadiusM;
  return tool;
}

// Three nodes: along the normal, leaning by 30 degrees, without a response.
ResponseTable three_presses() {
  return make_table(pressing_ball(),
                    {hertz_press(Eigen::Vector3d::UnitZ()),
                     hertz_press({0.5, 0.0, std::sqrt(0.75)}), NodeResponse{}});
}

const Eigen::Vector3d kAlongNormal = Eigen::Vector3d::UnitZ();

// 2 pi R int_0^y p(s) ds by the midpoint rule.
double integrated_pressure_n(const PressureLaw& law, double depth_m) {
  constexpr int kSteps = 20000;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    sum += law.pressure_pa(depth_m * (i + 0.5) / kSteps);
  }
  return 2.0 * std::numbers::pi * law.radius_m() * sum * depth_m / kSteps;
}

TEST(PressureLaw, IsHertzsClosedForm) {
  const ResponseTable responses = three_presses();
  const PressureLaw law = pressure_law(responses, 0, kAlongNormal);
  for (const double depth_m : {0.0003, 0.001, 0.002, 0.003}) {
    const double wanted =
        kReducedPa * std::sqrt(depth_m / kPressRadiusM) / std::numbers::pi;
    EXPECT_NEAR(law.pressure_pa(depth_m), wanted, 0.01 * wanted) << depth_m;
  }
}

TEST(PressureLaw, TheBallOnTheBedFeelsTheStoredCurve) {
  const ResponseTable responses = three_presses();
  for (const std::int64_t node : {0, 1}) {
    const PressureLaw law = pressure_law(responses, node, kAlongNormal);
    const double c = node == 0 ? 1.0 : std::sqrt(0.75);
    for (const double depth_m : {0.0005, 0.002, 0.003}) {
      const double stored = c * responses.curve(node).at(c * depth_m).force_n;
      EXPECT_NEAR(integrated_pressure_n(law, depth_m), stored, 1e-3 * stored);
      EXPECT_NEAR(law.force_n(depth_m, kPressRadiusM), stored, 1e-12 * stored);
    }
    EXPECT_NEAR(law.depth_max_m(), kPressDepthM / c, 1e-12);
  }
}

// The bed gives F ~ R at a depth, the half space sqrt(R).
TEST(PressureLaw, OfOtherRadiiErrsAsStated) {
  const ResponseTable responses = three_presses();
  const PressureLaw law = pressure_law(responses, 0, kAlongNormal);
  const auto error = [&](double radius_m) {
    const double body_n =
        4.0 / 3.0 * kReducedPa * std::sqrt(radius_m) * std::pow(kPressDepthM, 1.5);
    return law.force_n(kPressDepthM, radius_m) / body_n - 1.0;
  };
  EXPECT_NEAR(error(kPressRadiusM), 0.0, 1e-6);
  EXPECT_NEAR(error(2.0 * kPressRadiusM), std::sqrt(2.0) - 1.0, 1e-6);  // +41 %
  EXPECT_NEAR(error(0.5 * kPressRadiusM), std::sqrt(0.5) - 1.0, 1e-6);  // -29 %
}

// p = C sqrt(y): slope 6/5 C / sqrt(D), misfit 1/5, force 9/10.
TEST(LinearPressure, OfHertzMissesAFifth) {
  const ResponseTable responses = three_presses();
  const LinearPressure fit =
      linear_pressure(pressure_law(responses, 0, kAlongNormal), kPressDepthM);
  const double c = kReducedPa / (std::numbers::pi * std::sqrt(kPressRadiusM));
  EXPECT_NEAR(fit.slope_pa_per_m, 1.2 * c / std::sqrt(kPressDepthM),
              1e-3 * fit.slope_pa_per_m);
  EXPECT_NEAR(fit.misfit_relative, 0.2, 2e-3);
  EXPECT_NEAR(fit.force_error_relative, -0.1, 1e-3);
}

TEST(LinearPressure, OfASpringyBedIsExact) {
  NodeResponse response = hertz_press(kAlongNormal);  // f = k y^2, p ~ y
  for (std::size_t i = 0; i < response.depth_m.size(); ++i) {
    response.force_n[i] = 5000.0 * response.depth_m[i] * response.depth_m[i];
  }
  const ResponseTable responses = make_table(pressing_ball(), {response});
  const PressureLaw law = pressure_law(responses, 0, kAlongNormal);
  for (const double depth_m : {0.5 * kPressDepthM, kPressDepthM}) {
    const LinearPressure fit = linear_pressure(law, depth_m);
    EXPECT_NEAR(fit.slope_pa_per_m, 10000.0 / (2.0 * std::numbers::pi * kPressRadiusM),
                1e-3 * fit.slope_pa_per_m);
    EXPECT_LT(fit.misfit_relative, 1e-3);
    EXPECT_NEAR(fit.force_error_relative, 0.0, 1e-3);
  }
  for (const double wrong : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW((void)linear_pressure(law, wrong), InputError);
  }
}

TEST(PressureLaw, BetweenNodesMixesThemFromTheFirstTouchOn) {
  ResponseTable responses = three_presses();
  responses.touch_offset_m = {-0.0002, 0.0003, 0.0};
  Eigen::Matrix3d normals;
  normals << kAlongNormal, kAlongNormal, kAlongNormal;
  const PressureLaw law = pressure_law(responses, {0, 1, 2}, {0.5, 0.3, 0.2}, normals);
  const PressureLaw first = pressure_law(responses, 0, kAlongNormal);
  const PressureLaw second = pressure_law(responses, 1, kAlongNormal);
  for (const double depth_m : {0.0002, 0.001, 0.0025}) {
    EXPECT_NEAR(
        law.pressure_pa(depth_m),
        0.5 * first.pressure_pa(depth_m) + 0.3 * second.pressure_pa(depth_m - 0.0005),
        1e-9);
  }
  EXPECT_EQ(law.depth_max_m(), first.depth_max_m());
  const double wanted = law.force_n(0.0025, kPressRadiusM);
  EXPECT_NEAR(integrated_pressure_n(law, 0.0025), wanted, 1e-3 * wanted);
}

TEST(PressureLaw, EndsLevelAndBeginsAtZero) {
  const ResponseTable responses = three_presses();
  const PressureLaw law = pressure_law(responses, 0, kAlongNormal);
  EXPECT_EQ(law.pressure_pa(0.0), 0.0);
  EXPECT_EQ(law.pressure_pa(-1.0), 0.0);
  EXPECT_EQ(law.pressure_pa(2.0 * kPressDepthM),
            law.pressure_pa(kPressDepthM * (1.0 + 1e-9)));
  EXPECT_TRUE(std::isnan(law.pressure_pa(std::numeric_limits<double>::quiet_NaN())));
}

TEST(PressureLaw, IsOfASphereAndOfANodeWithAResponse) {
  ResponseTable responses = three_presses();
  EXPECT_THROW((void)pressure_law(responses, 2, kAlongNormal), InputError);
  EXPECT_THROW((void)pressure_law(responses, -1, kAlongNormal), InputError);
  EXPECT_THROW((void)pressure_law(responses, 3, kAlongNormal), InputError);
  EXPECT_THROW((void)pressure_law(responses, {2, 2, 2}, kAlongNormal,
                                  Eigen::Matrix3d::Identity()),
               InputError);
  responses.tool.kind = "flat-punch";
  EXPECT_THROW((void)pressure_law(responses, 0, kAlongNormal), InputError);
  responses.tool.kind = "sphere";
  responses.tool.contact.radius_m = {kPressRadiusM};
  EXPECT_THROW((void)pressure_law(responses, 0, kAlongNormal), InputError);
}

}  // namespace
}  // namespace palpate
