#include "fitting/material/moduli.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/synthetic_curve.h"

namespace palpate {
namespace {

constexpr double kYoung = 8e3;  // [Pa]

// 2 mm of free travel, then `force` of the depth, to 2 mm.
template <typename Force>
Approach press(Force force) {
  Measurement m;
  for (int i = 0; i <= 400; ++i) {
    const double x = 1e-5 * i, d = std::max(0.0, x - 2e-3);
    m.depth_m.push_back(x);
    m.force_n.push_back(d > 0.0 ? force(d) : 0.0);
  }
  return select_approach(m);
}

Modulus modulus(const Approach& approach, const Indenter& indenter) {
  return find_modulus(approach, fit_contact(approach), indenter);
}

TEST(Moduli, ComeBackFromTheirOwnLaws) {
  const double plane = kYoung / (1.0 - 0.16);
  Indenter sphere{"sphere", 0.01};
  Indenter punch{"flat-punch", 0.003};
  Indenter cone{"cone"};
  cone.half_angle_rad = std::numbers::pi / 3;
  sphere.poissons_ratio = punch.poissons_ratio = cone.poissons_ratio = 0.4;
  const Modulus of_sphere =
      modulus(press([&](double d) {
                return 4.0 / 3.0 * plane * std::sqrt(0.01) * std::pow(d, 1.5);
              }),
              sphere);
  const Modulus of_cone = modulus(press([&](double d) {
                                    return 2.0 / std::numbers::pi * plane *
                                           std::tan(cone.half_angle_rad) * d * d;
                                  }),
                                  cone);
  const auto flat = [&](double d) {
    return 2.0 * plane * 0.003 * d;
  };
  const Modulus of_punch = modulus(press(flat), punch);
  for (const Modulus& m : {of_sphere, of_cone, of_punch}) {
    EXPECT_EQ(m.refused, "");
    EXPECT_NEAR(m.youngs_modulus_pa, kYoung, 1e-3 * kYoung) << m.law;
  }
  punch.thickness_m = 0.003;
  EXPECT_NEAR(modulus(press(flat), punch).youngs_modulus_pa, kYoung / 2.794,
              2e-3 * kYoung);
}

constexpr double kSphere = 0.03;  // [m]

Modulus of_sphere(const SyntheticCurve& curve, unsigned seed, double nu = 0.5,
                  double radius_m = kSphere) {
  Indenter sphere{"sphere", radius_m};
  sphere.poissons_ratio = nu;
  return modulus(select_approach(synthetic(curve, seed)), sphere);
}

// F = 1 N at 5 mm = 4/3 E/(1 - nu^2) sqrt(R) (5 mm)^1.5
double exact_pa(double nu) {
  return 0.75 * (1.0 - nu * nu) / std::sqrt(kSphere) / std::pow(5e-3, 1.5);
}

TEST(Moduli, InvertHertz) {
  for (const double nu : {0.0, 0.3, 0.5}) {
    const Modulus result = of_sphere({.noise_n = 0.0}, 1, nu);
    EXPECT_EQ(result.refused, "");
    EXPECT_NEAR(result.youngs_modulus_pa, exact_pa(nu), 1e-6 * exact_pa(nu));
    EXPECT_TRUE(result.flags.empty());
  }
}

// Of 24 runs about 1 lies beyond 2 standard deviations, 4 hardly ever.
TEST(Moduli, StateHowFarTheyMayBeOff) {
  int beyond_two = 0;
  for (unsigned seed = 1; seed <= 24; ++seed) {
    const Modulus result = of_sphere({}, seed);
    EXPECT_GT(result.sd_pa, 0.0);
    EXPECT_LT(result.sd_pa, 0.02 * exact_pa(0.5));
    beyond_two +=
        std::abs(result.youngs_modulus_pa - exact_pa(0.5)) > 2.0 * result.sd_pa ? 1 : 0;
  }
  EXPECT_LE(beyond_two, 4);
}

TEST(Moduli, SayWhereTheCurveIsNotHertz) {
  const auto has = [](const Modulus& m, FitFlag flag) {
    return std::find(m.flags.begin(), m.flags.end(), flag) != m.flags.end();
  };
  EXPECT_TRUE(has(of_sphere({.exponent = 2.2}, 1), FitFlag::kHertzExponentRefuted));
  EXPECT_TRUE(has(of_sphere({}, 1, 0.5, 0.01), FitFlag::kHertzDepthExceeded));
}

TEST(Moduli, AreRefusedWithoutAContactPoint) {
  const Modulus result = of_sphere({.exponent = 1.2, .free_m = 0.0}, 1);
  EXPECT_NE(result.refused.find("already in contact"), std::string::npos);
  EXPECT_TRUE(std::isnan(result.youngs_modulus_pa));
}

TEST(Moduli, OfASphereOnALayerTakesTheLayerOff) {
  Indenter sphere{"sphere", 0.005};
  sphere.thickness_m = 0.006;
  const double plane = kYoung / 0.75;
  const Modulus m = modulus(press([&](double d) {
                              const double chi = std::sqrt(0.005 * d) / 0.006;
                              return 4.0 / 3.0 * plane * std::sqrt(0.005) *
                                     std::pow(d, 1.5) * sphere_layer_factor(chi, 0.5);
                            }),
                            sphere);
  EXPECT_EQ(m.law, "Hertz on a layer");
  EXPECT_NEAR(m.youngs_modulus_pa, kYoung, 0.02 * kYoung);
}

TEST(Moduli, OfAPlateIsStressOverStrain) {
  Indenter plate{"plate", 0.025};
  plate.height_m = 0.03;
  const double area = std::numbers::pi * 0.025 * 0.025;
  const Modulus m = modulus(press([&](double d) {
                              return kYoung * area * d / 0.03;
                            }),
                            plate);
  EXPECT_NEAR(m.youngs_modulus_pa, kYoung, 1e-3 * kYoung);
}

TEST(Moduli, AreRefusedWithTheReason) {
  const Approach approach = press([](double d) {
    return 100.0 * d;
  });
  EXPECT_NE(modulus(approach, Indenter{}).refused.find("geometry"), std::string::npos);
  Indenter punch{"flat-punch", 0.003};
  punch.thickness_m = 0.001;
  EXPECT_NE(modulus(approach, punch).refused.find("cover [0, 2]"), std::string::npos);
  punch.thickness_m = 0.01;
  punch.poissons_ratio = 0.2;
  EXPECT_NE(modulus(approach, punch).refused.find("0.2"), std::string::npos);
}

TEST(LayerFactor, IsTheTableAtItsNodesAndOneOnAHalfSpace) {
  EXPECT_NEAR(punch_layer_factor(0.6, 0.45), 2.033, 1e-12);
  EXPECT_NEAR(punch_layer_factor(2.0, 0.5), 9.149, 1e-12);
  EXPECT_EQ(punch_layer_factor(0.0, 0.3), 1.0);
  EXPECT_EQ(sphere_layer_factor(0.0, 0.4), 1.0);
  EXPECT_NEAR(sphere_layer_factor(0.3444, 0.5), 1.6355, 1e-12);
  EXPECT_THROW((void)punch_layer_factor(2.1, 0.5), InputError);
  EXPECT_THROW((void)sphere_layer_factor(5.0, 0.5), InputError);
  EXPECT_THROW((void)sphere_layer_factor(0.1, 0.2), InputError);
}

// Two tables of one solution: coarse in a/h for three ratios, fine in depth for 0.5.
TEST(LayerFactor, TablesOfTheSphereAgree) {
  for (const double chi : {0.1851, 0.4869}) {
    EXPECT_NEAR(sphere_layer_factor(chi, 0.4999), sphere_layer_factor(chi, 0.5),
                0.02 * sphere_layer_factor(chi, 0.5));
  }
}

}  // namespace
}  // namespace palpate
