#include "precompute/press/tip_depth.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr TipTissue kTipTissue{.youngs_modulus_pa = 15000.0, .poissons_ratio = 0.45};
constexpr double kPlanePa = 15000.0 / (1.0 - 0.45 * 0.45);
constexpr double kRadiusM = 0.001;

// F at a depth, by bisection of the depth at a force.
template <typename Depth>
double bisected_force_n(double depth_m, const Depth& depth_m_at) {
  double low = 0.0;
  double high = 100.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (depth_m_at(middle) < depth_m ? low : high) = middle;
  }
  return low;
}

double linear_force_n(double depth_m) {
  return bisected_force_n(depth_m, [](double f) {
    return linear_tip_depth_m(kTipTissue, kRadiusM, f);
  });
}

// F / (E R^2) at h / R.
double deep_force(double poissons_ratio, double radii) {
  const TipTissue tissue{.youngs_modulus_pa = 2000.0, .poissons_ratio = poissons_ratio};
  return bisected_force_n(0.002 * radii,
                          [&](double f) {
                            return nonlinear_tip_depth_m(tissue, 0.002, f);
                          }) /
         (2000.0 * 0.002 * 0.002);
}

double deep_slope(double radii) {
  return (deep_force(0.5, radii + 1e-4) - deep_force(0.5, radii - 1e-4)) / 2e-4;
}

TEST(LinearTip, IsAnExactSphere) {
  // Sneddon 1965: d/R and F over that of Hertz.
  for (const auto& [x, part] : {std::pair{0.05, 0.9950},
                                {0.10, 0.9900},
                                {0.30, 0.9699},
                                {0.50, 0.9498},
                                {1.00, 0.8998}}) {
    const double depth_m = x * kRadiusM;
    const double hertz_n =
        4.0 / 3.0 * kPlanePa * std::sqrt(kRadiusM) * std::pow(depth_m, 1.5);
    EXPECT_NEAR(linear_force_n(depth_m) / hertz_n, part, 1e-4) << x;
  }
  EXPECT_EQ(linear_tip_depth_m(kTipTissue, kRadiusM, 0.0), 0.0);
}

TEST(LinearTip, IsAFlatPunchDeepDown) {
  const double h_m = 1e-4;
  for (const double x : {10.0, 20.0, 400.0}) {
    const double slope =
        (linear_force_n(x * kRadiusM + h_m) - linear_force_n(x * kRadiusM - h_m)) /
        (2.0 * h_m);
    EXPECT_NEAR(slope / (2.0 * kPlanePa * kRadiusM), 1.0, 1e-6) << x;
  }
}

// tests/bench/deep_tip prints these, each within 1 % of its own.
TEST(DeepTip, IsWhatAFiniteElementSolutionFinds) {
  for (const auto& [x, force] : {std::pair{0.05, 0.0196},
                                 {0.1, 0.0546},
                                 {0.2, 0.1518},
                                 {0.3, 0.2737},
                                 {0.5, 0.5694},
                                 {0.7, 0.9107},
                                 {1.0, 1.4679},
                                 {1.5, 2.4246},
                                 {2.0, 3.2683},
                                 {2.5, 3.9833},
                                 {3.0, 4.7006},
                                 {3.5, 5.4725},
                                 {4.0, 6.2918}}) {
    EXPECT_NEAR(deep_force(0.5, x) / force, 1.0, 0.01) << x;
  }
}

// The same with --nu: 0.45 and 0.3.
TEST(DeepTip, TurnsIntoOtherPoissonsRatios) {
  for (const auto& [x, force] : {std::pair{0.05, 0.0186},
                                 {0.5, 0.5489},
                                 {1.0, 1.4320},
                                 {1.5, 2.3940},
                                 {2.0, 3.2684},
                                 {2.5, 4.0116},
                                 {3.0, 4.7558}}) {
    EXPECT_NEAR(deep_force(0.45, x) / force, 1.0, 0.015) << x;
  }
  for (const auto& [x, force] :
       {std::pair{0.05, 0.0167}, {0.3, 0.2438}, {0.7, 0.8424}}) {
    EXPECT_NEAR(deep_force(0.3, x) / force, 1.0, 0.04) << x;
  }
}

TEST(DeepTip, BeginsAsHertzAndEndsAsAThimble) {
  for (const double nu : {0.3, 0.45, 0.5}) {
    const double hertz = 4.0 / 3.0 / (1.0 - nu * nu);
    EXPECT_NEAR(deep_force(nu, 1e-3) / (hertz * std::pow(1e-3, 1.5)), 1.0, 0.01) << nu;
    EXPECT_NEAR(deep_force(nu, 0.05) / (hertz * std::pow(0.05, 1.5)), 1.0, 0.03) << nu;
    EXPECT_NEAR(deep_force(nu, 0.1) / (hertz * std::pow(0.1, 1.5)), 1.0, 0.03) << nu;
  }
  const double thimble = 2.0 * std::numbers::pi / 3.0;
  EXPECT_NEAR(deep_slope(20.0) / thimble, 1.0, 0.03);
  EXPECT_NEAR(deep_slope(1000.0) / thimble, 1.0, 1e-3);
  EXPECT_EQ(nonlinear_tip_depth_m(kTipTissue, kRadiusM, 0.0), 0.0);
}

// The slope falls around 2 radii, where the tip begins to draw the tissue along.
TEST(DeepTip, RisesEverywhereAndItsSlopeHasNoJump) {
  double before = deep_slope(0.02);
  for (double x = 0.03; x < 12.0; x += 0.01) {
    const double slope = deep_slope(x);
    EXPECT_GT(slope, 0.0) << x;
    // As Hertz' at first, by 0.5 / x.
    EXPECT_NEAR(slope / before, 1.0, 0.03 + 0.01 * 0.7 / x) << x;
    before = slope;
  }
  for (double f = 0.1; f < 1e3; f *= 1.3) {
    EXPECT_GT(nonlinear_tip_depth_m(kTipTissue, kRadiusM, 1.01 * f),
              nonlinear_tip_depth_m(kTipTissue, kRadiusM, f));
  }
}

// Sneddon 1965 of a profile with the slope cot alpha, by the midpoint rule:
//   h = a \int_0^1 cot alpha / sqrt(1 - x^2) dx
//   F = 2 E / (1 - nu^2) a^2 \int_0^1 x^2 cot alpha / sqrt(1 - x^2) dx
TEST(LinearCone, IsSneddonsUntilItsContactIsAsWideAsTheShaft) {
  constexpr int kParts = 2000;
  for (const double half_angle : {0.15, 0.5, 0.9}) {
    double h = 0.0, f = 0.0;
    for (int i = 0; i < kParts; ++i) {  // x = sin s
      const double s = (i + 0.5) * 0.5 * std::numbers::pi / kParts;
      h += 0.5 * std::numbers::pi / kParts / std::tan(half_angle);
      f += 0.5 * std::numbers::pi / kParts / std::tan(half_angle) * std::sin(s) *
           std::sin(s);
    }
    const NeedleTip tip{.radius_m = kRadiusM, .half_angle_rad = half_angle};
    for (const double share : {0.01, 0.3, 1.0}) {
      const double a_m = share * kRadiusM;
      const double force_n = 2.0 * kPlanePa * a_m * a_m * f;
      EXPECT_NEAR(linear_cone_depth_m(kTipTissue, tip, force_n) / (a_m * h), 1.0, 1e-9)
          << half_angle << " " << share;
      // (2/pi) E / (1 - nu^2) tan alpha h^2
      EXPECT_NEAR(2.0 / std::numbers::pi * kPlanePa * std::tan(half_angle) *
                      std::pow(a_m * h, 2) / force_n,
                  1.0, 1e-9);
    }
  }
  EXPECT_EQ(linear_cone_depth_m(kTipTissue, {kRadiusM, 0.5}, 0.0), 0.0);
}

TEST(LinearCone, IsAFlatPunchBeyondAndJoinsItWithoutAStep) {
  const NeedleTip tip{.radius_m = kRadiusM, .half_angle_rad = 0.4};
  const double join_n =
      0.5 * std::numbers::pi * kPlanePa * kRadiusM * kRadiusM / std::tan(0.4);
  const double punch_n_per_m = 2.0 * kPlanePa * kRadiusM;
  const auto depth_m = [&](double times) {
    return linear_cone_depth_m(kTipTissue, tip, times * join_n);
  };
  for (const double times : {1.0, 3.0, 50.0}) {
    EXPECT_NEAR((depth_m(times + 0.1) - depth_m(times)) * punch_n_per_m, 0.1 * join_n,
                1e-9 * join_n)
        << times;
  }
  // h goes as the root of F up to there: on both sides 1e-4 F_R / (2 E R).
  const double step_m = 1e-4 * join_n / punch_n_per_m;
  EXPECT_NEAR((depth_m(1.0) - depth_m(1.0 - 1e-4)) / step_m, 1.0, 1e-4);
  EXPECT_NEAR((depth_m(1.0 + 1e-4) - depth_m(1.0)) / step_m, 1.0, 1e-9);
}

// What scenes may ask for.
TEST(LinearCone, SinksDeeperThanAHemisphereUpTo110Degrees) {
  for (const double angle_deg : {10.0, 60.0, 110.0}) {
    const NeedleTip tip{.radius_m = kRadiusM,
                        .half_angle_rad = 0.5 * angle_deg * std::numbers::pi / 180.0};
    for (double force_n = 1e-6; force_n < 100.0; force_n *= 1.5) {
      EXPECT_GT(linear_cone_depth_m(kTipTissue, tip, force_n),
                linear_tip_depth_m(kTipTissue, kRadiusM, force_n))
          << angle_deg << " " << force_n;
    }
  }
}

}  // namespace
}  // namespace palpate
