#include "formats/response/response_curve.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

// A sphere on a half-space: f = K d^1.5, sampled as a simulation would.
ResponseCurve hertz_curve(int samples, double depth_max_m, double k) {
  std::vector<double> depth, force;
  for (int i = 0; i < samples; ++i) {
    const double d = depth_max_m * i / (samples - 1);
    depth.push_back(d);
    force.push_back(k * std::pow(d, 1.5));
  }
  return {depth, force};
}

TEST(ResponseCurve, PassesThroughItsSamples) {
  const std::vector<double> depth = {0.0, 0.001, 0.004};
  const std::vector<double> force = {0.0, 0.5, 0.7};
  const ResponseCurve curve(depth, force);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    EXPECT_DOUBLE_EQ(curve.at(depth[i]).force_n, force[i]);
  }
}

TEST(ResponseCurve, EnergyIsTheIntegralOfForce) {
  const ResponseCurve curve = hertz_curve(12, 0.005, 3000.0);
  const double step = 1e-7;
  double work = 0.0;  // midpoint rule, error ~ step^2
  for (double d = step / 2; d < 0.008; d += step) {
    work += curve.at(d).force_n * step;
    ASSERT_NEAR(curve.at(d + step / 2).energy_j, work, 1e-12);
  }
}

TEST(ResponseCurve, StiffnessIsTheDerivativeOfForce) {
  const ResponseCurve curve = hertz_curve(12, 0.005, 3000.0);
  const double step = 1e-9;
  for (double d = 1e-5; d < 0.006; d += 3.7e-5) {
    const double difference =
        (curve.at(d + step).force_n - curve.at(d - step).force_n) / (2 * step);
    EXPECT_NEAR(curve.at(d).stiffness_n_per_m, difference, 1e-4 * (1 + difference));
  }
}

TEST(ResponseCurve, RisesWhereItsSamplesRise) {
  // A sharp knee: an unlimited cubic spline would overshoot here.
  const std::vector<double> depth = {0.0, 0.001, 0.002, 0.0021, 0.005};
  const std::vector<double> force = {0.0, 0.001, 0.002, 2.0, 2.001};
  const ResponseCurve curve(depth, force);
  double before = 0.0;
  for (double d = 0.0; d <= 0.005; d += 1e-6) {
    ASSERT_GE(curve.at(d).force_n, before);
    before = curve.at(d).force_n;
  }
}

TEST(ResponseCurve, StiffnessMaxBoundsEveryStiffness) {
  const std::vector<double> depth = {0.0, 0.001, 0.002, 0.0021, 0.005};
  const std::vector<double> force = {0.0, 0.001, 0.002, 2.0, 2.001};
  const ResponseCurve curve(depth, force);
  double largest = 0.0;
  for (double d = 0.0; d <= 0.005; d += 1e-7) {
    largest = std::max(largest, curve.at(d).stiffness_n_per_m);
  }
  EXPECT_LE(largest, curve.stiffness_max_n_per_m() * (1 + 1e-12));
  EXPECT_GE(largest, curve.stiffness_max_n_per_m() * (1 - 1e-3));
}

TEST(ResponseCurve, GoesOnLinearlyBeyondTheLastSampleAndSaysSo) {
  const ResponseCurve curve = hertz_curve(12, 0.005, 3000.0);
  const ResponseSample end = curve.at(0.005);
  const ResponseSample past = curve.at(0.006);
  EXPECT_FALSE(end.extrapolated);
  EXPECT_TRUE(past.extrapolated);
  EXPECT_NEAR(past.force_n, end.force_n + 0.001 * end.stiffness_n_per_m, 1e-12);
}

TEST(ResponseCurve, IsZeroInFreeSpaceAndPassesNanOn) {
  const ResponseCurve curve = hertz_curve(12, 0.005, 3000.0);
  EXPECT_EQ(curve.at(-1.0).force_n, 0.0);
  EXPECT_EQ(curve.at(0.0).energy_j, 0.0);
  EXPECT_TRUE(std::isnan(curve.at(std::nan("")).force_n));
}

TEST(ResponseCurve, NamesTheSampleThatIsWrong) {
  const std::vector<double> depth = {0.0, 0.002, 0.001};
  const std::vector<double> force = {0.0, 1.0, 2.0};
  try {
    const ResponseCurve curve(depth, force);
    FAIL() << "accepted a depth that goes back";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("sample 2 is (0.001 m"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace palpate
