#include "runtime/slow/thinned_curve.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "formats/response/response_curve.h"

namespace palpate {
namespace {

ResponseCurve sampled(int samples, double depth_max_m, double (*force)(double)) {
  std::vector<double> depth;
  std::vector<double> value;
  for (int i = 0; i < samples; ++i) {
    depth.push_back(depth_max_m * i / (samples - 1));
    value.push_back(force(depth.back()));
  }
  return {depth, value};
}

double hertz(double d) {
  return 3000.0 * std::pow(d, 1.5);
}

double staircase(double d) {
  return std::floor(d * 2e4) * 0.01;
}

TEST(ElementCurve, CopiesACurveThatFits) {
  const ResponseCurve curve = sampled(kElementSamples, 0.005, hertz);
  ElementNode node;
  EXPECT_EQ(set_curve(node, curve.view()), 0.0);
  ASSERT_EQ(node.samples, static_cast<std::int32_t>(kElementSamples));
  for (double d = -0.001; d < 0.006; d += 1e-5) {
    EXPECT_EQ(node.curve().at(d).force_n, curve.at(d).force_n);
    EXPECT_EQ(node.curve().at(d).energy_j, curve.at(d).energy_j);
  }
}

TEST(ElementCurve, ThinsASmoothCurveWithASmallLossThatItMeasures) {
  const ResponseCurve curve = sampled(500, 0.005, hertz);
  ElementNode node;
  const double loss = set_curve(node, curve.view());
  EXPECT_LE(node.samples, static_cast<std::int32_t>(kElementSamples));
  EXPECT_LT(loss, 1e-4 * hertz(0.005));  // 47 cubics on d^1.5
  double largest = 0.0;
  for (double d = 0.0; d <= 0.005; d += 1e-6) {
    largest =
        std::max(largest, std::abs(node.curve().at(d).force_n - curve.at(d).force_n));
  }
  EXPECT_LE(largest, 1.5 * loss);
}

TEST(ElementCurve, KeepsTheEnergyTheIntegralOfTheForce) {
  const ResponseCurve curve = sampled(300, 0.005, staircase);
  ElementNode node;
  set_curve(node, curve.view());
  const double step = 1e-7;
  double work = 0.0;  // midpoint rule, error ~ step^2
  for (double d = step / 2; d < 0.006; d += step) {
    work += node.curve().at(d).force_n * step;
    ASSERT_NEAR(node.curve().at(d + step / 2).energy_j, work, 1e-9);
  }
}

TEST(ElementCurve, DoesNotOvershootWhereTheSamplesRise) {
  const ResponseCurve curve = sampled(300, 0.005, staircase);
  ElementNode node;
  set_curve(node, curve.view());
  double before = 0.0;
  for (double d = 0.0; d <= 0.005; d += 1e-6) {
    ASSERT_GE(node.curve().at(d).force_n, before - 1e-12);
    before = node.curve().at(d).force_n;
  }
}

TEST(ElementCurve, HasNoSamplesForNoCurve) {
  ElementNode node;
  EXPECT_EQ(set_curve(node, CurveView{}), 0.0);
  EXPECT_EQ(node.samples, 0);
}

}  // namespace
}  // namespace palpate
