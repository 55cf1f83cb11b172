#include "precompute/material/material_check.h"

#include <array>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "precompute/material/material.h"

namespace palpate {
namespace {

const Eigen::Vector3d kX = Eigen::Vector3d::UnitX();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <typename Make>
std::string refusal(Make make) {
  try {
    (void)make();
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(MaterialCheck, YoungsModulusMustBePositiveAndFinite) {
  for (const double E : {0.0, -5.0, kNan, kInfinity}) {
    EXPECT_THROW((void)linear(E, 0.3), InputError);
    EXPECT_THROW((void)st_venant_kirchhoff(E, 0.3), InputError);
    EXPECT_THROW((void)neo_hookean(E, 0.3), InputError);
    EXPECT_THROW((void)fibre_exponential(E, 0.3, 1.0, 1.0, kX), InputError);
  }
  EXPECT_EQ(refusal([] {
              return neo_hookean(-5.0, 0.3);
            }),
            "Young's modulus is -5 Pa; must be positive");
}

TEST(MaterialCheck, PoissonsRatioMustLieWithinItsLimits) {
  for (const double nu : {-1.0, 0.5, 0.6, kNan}) {
    EXPECT_THROW((void)linear(1.0, nu), InputError);
    EXPECT_THROW((void)st_venant_kirchhoff(1.0, nu), InputError);
    EXPECT_THROW((void)neo_hookean(1.0, nu), InputError);
    EXPECT_THROW((void)mooney_rivlin(1.0, 1.0, nu), InputError);
    EXPECT_THROW((void)ogden(std::array{1.0}, std::array{2.0}, nu), InputError);
    EXPECT_THROW((void)fibre_exponential(1.0, nu, 1.0, 1.0, kX), InputError);
  }
  EXPECT_EQ(refusal([] {
              return linear(1.0, 0.5);
            }),
            "Poisson's ratio is 0.5; must lie between -1 and 0.5, both excluded");
}

TEST(MaterialCheck, MooneyRivlinNeedsAPositiveShearModulus) {
  EXPECT_THROW((void)mooney_rivlin(1.0, -1.0, 0.3), InputError);
  EXPECT_THROW((void)mooney_rivlin(kNan, 1.0, 0.3), InputError);
  EXPECT_NO_THROW((void)mooney_rivlin(2.0, -1.0, 0.3));
}

TEST(MaterialCheck, OgdenNeedsPairsOfFiniteConstantsAndAPositiveShearModulus) {
  const auto make = [](std::initializer_list<double> mu,
                       std::initializer_list<double> alpha) {
    return refusal([&] {
      return ogden(std::span(mu.begin(), mu.size()),
                   std::span(alpha.begin(), alpha.size()), 0.4);
    });
  };
  EXPECT_EQ(make({1.0}, {2.0}), "accepted");
  EXPECT_EQ(
      make({}, {}),
      "Ogden's law has 0 moduli and 0 exponents; must be as many of both, 1 to 4");
  EXPECT_EQ(
      make({1.0, 1.0}, {2.0}),
      "Ogden's law has 2 moduli and 1 exponents; must be as many of both, 1 to 4");
  EXPECT_NE(make({1, 1, 1, 1, 1}, {2, 2, 2, 2, 2}), "accepted");
  EXPECT_EQ(
      make({1.0, 1.0}, {2.0, 0.0}),
      "term 2 of Ogden's law has modulus 1 Pa and exponent 0; must be finite, the "
      "exponent not 0");
  EXPECT_NE(make({1.0}, {kNan}), "accepted");
  EXPECT_NE(make({kInfinity}, {2.0}), "accepted");
  EXPECT_EQ(
      make({1.0}, {-2.0}),
      "Ogden's shear modulus, half the sum of modulus times exponent, is -1 Pa; must "
      "be positive");
}

TEST(MaterialCheck, TransverseModuliMustBePositiveDefinite) {
  const auto make = [](double E_l, double E_t, double G, double nu_lt, double nu_tt) {
    return refusal([&] {
      return transversely_isotropic(E_l, E_t, G, nu_lt, nu_tt, kX, false);
    });
  };
  EXPECT_EQ(make(2.0, 1.0, 1.0, 0.3, 0.3), "accepted");
  for (const double bad : {0.0, -1.0, kNan, kInfinity}) {
    EXPECT_NE(make(bad, 1.0, 1.0, 0.3, 0.3), "accepted");
    EXPECT_NE(make(1.0, bad, 1.0, 0.3, 0.3), "accepted");
    EXPECT_NE(make(1.0, 1.0, bad, 0.3, 0.3), "accepted");
  }
  EXPECT_NE(make(1.0, 1.0, 1.0, 0.0, 1.0), "accepted");
  EXPECT_NE(make(1.0, 1.0, 1.0, 0.0, -1.0), "accepted");
  EXPECT_NE(make(1.0, 1.0, 1.0, kNan, 0.3), "accepted");
  // (1 - nu_tt) E_l/E_t = 2 nu_lt^2 is the edge: 0.5 4/1 = 2 1^2.
  EXPECT_EQ(make(4.0, 1.0, 1.0, 0.999, 0.5), "accepted");
  EXPECT_EQ(
      make(4.0, 1.0, 1.0, 1.0, 0.5),
      "Poisson's ratio from along to across the fibre is 1; must lie between -1 and "
      "1 for these moduli, both excluded");
}

TEST(MaterialCheck, FibresNeedADirectionAndAnExponent) {
  EXPECT_EQ(refusal([] {
              return fibre_exponential(1.0, 0.3, 1.0, 1.0, Eigen::Vector3d::Zero());
            }),
            "fibre direction is (0, 0, 0); must be finite and not zero");
  EXPECT_THROW((void)transversely_isotropic(1, 1, 1, 0.3, 0.3, {kNan, 0, 0}, false),
               InputError);
  EXPECT_THROW((void)fibre_exponential(1.0, 0.3, -1.0, 1.0, kX), InputError);
  EXPECT_THROW((void)fibre_exponential(1.0, 0.3, 1.0, 0.0, kX), InputError);
  const FibreExponential law = fibre_exponential(1.0, 0.3, 1.0, 1.0, {0, 0, -1e-200});
  EXPECT_EQ(law.fibre, Eigen::Vector3d(0, 0, -1));
}

}  // namespace
}  // namespace palpate
