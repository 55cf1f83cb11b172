// Elementary functions: the library's values, and the same bits without fused
// operations.
#include "formats/base/reproducible.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>
#ifdef PALPATE_TEST_SLEEF
#include <sleef.h>
#endif

#include "formats/base/sha256.h"
#include "tests/support/other_processor.h"

namespace palpate {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// One function, the C library's of the same name, and that in long double.
struct Function {
  const char* name;
  double (*ours)(double);
  double (*library)(double);
  long double (*exact)(long double);
  double from, to;
};

constexpr double kPower = 0.1;
constexpr double kAdjacent = 0.75;
double power(double x) {
  return reproducible::pow(x, kPower);
}
double library_power(double x) {
  return std::pow(x, kPower);
}
long double exact_power(long double x) {
  return std::pow(x, static_cast<long double>(kPower));
}
double angle(double x) {
  return reproducible::atan2(x, kAdjacent);
}
double library_angle(double x) {
  return std::atan2(x, kAdjacent);
}
long double exact_angle(long double x) {
  return std::atan2(x, static_cast<long double>(kAdjacent));
}

const std::array kFunctions{
    Function{"exp", reproducible::exp, std::exp, std::exp, -30.0, 30.0},
    Function{"expm1", reproducible::expm1, std::expm1, std::expm1, -1.0, 1.0},
    Function{"log", reproducible::log, std::log, std::log, 1e-3, 30.0},
    Function{"log1p", reproducible::log1p, std::log1p, std::log1p, -0.5, 0.5},
    Function{"cbrt", reproducible::cbrt, std::cbrt, std::cbrt, -10.0, 10.0},
    Function{"sin", reproducible::sin, std::sin, std::sin, -10.0, 10.0},
    Function{"cos", reproducible::cos, std::cos, std::cos, -10.0, 10.0},
    Function{"tan", reproducible::tan, std::tan, std::tan, -1.5, 1.5},
    Function{"tanh", reproducible::tanh, std::tanh, std::tanh, -3.0, 3.0},
    Function{"acos", reproducible::acos, std::acos, std::acos, -1.0, 1.0},
    Function{"erfc", reproducible::erfc, std::erfc, std::erfc, -3.0, 3.0},
    Function{"pow", power, library_power, exact_power, 0.0, 100.0},
    Function{"atan2", angle, library_angle, exact_angle, -10.0, 10.0},
};

double spacing(double x) {
  return std::nextafter(std::abs(x), kInfinity) - std::abs(x);
}

template <typename Each>
void for_each_argument(const Function& f, Each each) {
  std::mt19937_64 random(20);
  for (int i = 0; i < 20000; ++i) {
    each(f.from + (f.to - f.from) * static_cast<double>(random() >> 11) * 0x1p-53);
  }
}

std::string digest(const Function& f, double (*function)(double)) {
  Sha256 sum;
  for_each_argument(f, [&](double x) {
    const double value = function(x);
    sum.update(std::as_bytes(std::span(&value, 1)));
  });
  return sum.hex();
}

TEST(Reproducible, IsRightToAUnitInTheLastPlace) {
  for (const Function& f : kFunctions) {
    const long double units = std::string(f.name) == "erfc" ? 1.5L : 1.0L;
    for_each_argument(f, [&](double x) {
      const long double exact = f.exact(x);
      ASSERT_LE(std::abs(f.ours(x) - exact),
                units * spacing(static_cast<double>(exact)))
          << f.name << " " << x;
    });
  }
}

TEST(Reproducible, IsExactWhereLawsCountOnIt) {
  EXPECT_EQ(reproducible::exp(0.0), 1.0);
  EXPECT_EQ(reproducible::expm1(0.0), 0.0);
  EXPECT_EQ(reproducible::expm1(1e-300), 1e-300);
  EXPECT_EQ(reproducible::expm1(-kInfinity), -1.0);
  EXPECT_EQ(reproducible::expm1(800.0), kInfinity);
  EXPECT_EQ(reproducible::log(1.0), 0.0);
  EXPECT_EQ(reproducible::log(0.0), -kInfinity);
  EXPECT_TRUE(std::isnan(reproducible::log(-1.0)));
  EXPECT_EQ(reproducible::log1p(1e-300), 1e-300);
  EXPECT_EQ(reproducible::log1p(-1.0), -kInfinity);
  EXPECT_EQ(reproducible::pow(0.0, 1.5), 0.0);
  EXPECT_EQ(reproducible::pow(3.0, 2.0), 9.0);
  EXPECT_EQ(reproducible::atan2(0.0, 2.0), 0.0);
  EXPECT_EQ(reproducible::atan2(0.0, 0.0), 0.0);
  EXPECT_EQ(reproducible::atan2(0.0, -2.0), std::numbers::pi);
  EXPECT_EQ(reproducible::atan2(2.0, 0.0), 0.5 * std::numbers::pi);
}

TEST(Reproducible, IsNotANumberBeyondItsDomain) {
  for (const auto function :
       {reproducible::sin, reproducible::cos, reproducible::tan}) {
    EXPECT_FALSE(std::isnan(function(-9e13)));
    EXPECT_TRUE(std::isnan(function(1e14)));
    EXPECT_TRUE(std::isnan(function(kInfinity)));
  }
}

#ifdef PALPATE_TEST_SLEEF
bool same(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) ||
         std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

// Of every size and sign, and of the size where a body's numbers are.
template <typename Each>
void for_each_number(Each each) {
  std::mt19937_64 random(7);
  for (const double x : {0.0,
                         0.5,
                         1.0,
                         2.0,
                         3.0,
                         15.0,
                         1e9,
                         9.9e13,
                         18.71,
                         27.3,
                         36.8,
                         709.78,
                         709.79,
                         745.2,
                         1000.0,
                         1001.0,
                         1e307,
                         5e-324,
                         1e-310,
                         0x1p53,
                         kInfinity,
                         std::numeric_limits<double>::max(),
                         std::numeric_limits<double>::min(),
                         std::numeric_limits<double>::quiet_NaN()}) {
    each(x);
    each(-x);
  }
  for (int i = 0; i < 100000; ++i) {
    each(std::bit_cast<double>(random()));
    const double u = static_cast<double>(random() >> 11) * 0x1p-52 - 1.0;
    for (const double size : {1e-6, 1.0, 40.0, 750.0, 1e5, 1e12}) {
      each(u * size);
    }
  }
}

TEST(Reproducible, HasTheBitsOfSleef) {
  const std::array sleef{Sleef_cinz_expd1_u10purec,  Sleef_cinz_expm1d1_u10purec,
                         Sleef_cinz_logd1_u10purec,  Sleef_cinz_log1pd1_u10purec,
                         Sleef_cinz_cbrtd1_u10purec, Sleef_cinz_sind1_u10purec,
                         Sleef_cinz_cosd1_u10purec,  Sleef_cinz_tand1_u10purec,
                         Sleef_cinz_tanhd1_u10purec, Sleef_cinz_acosd1_u10purec,
                         Sleef_cinz_erfcd1_u15purec};
  for (std::size_t f = 0; f < sleef.size(); ++f) {
    const std::string name = kFunctions[f].name;
    const double most =
        name == "sin" || name == "cos" || name == "tan" ? 1e14 : kInfinity;
    for_each_number([&](double x) {
      if (!(std::abs(x) >= most)) {
        ASSERT_TRUE(same(kFunctions[f].ours(x), sleef[f](x))) << name << " " << x;
      }
    });
  }
  double before = 1.5;
  for_each_number([&](double x) {
    for (const double y : {before, 2.0, -0.1, 7.0, std::trunc(before)}) {
      ASSERT_TRUE(same(reproducible::pow(x, y), Sleef_cinz_powd1_u10purec(x, y)))
          << x << " to the " << y;
      ASSERT_TRUE(same(reproducible::atan2(x, y), Sleef_cinz_atan2d1_u10purec(x, y)))
          << x << " over " << y;
    }
    before = x;
  });
}
#endif

// What the next test runs in a process of its own.
TEST(Reproducible, DISABLED_PrintsDigests) {
  for (const Function& f : kFunctions) {
    std::cout << "ours " << f.name << " " << digest(f, f.ours) << "\n"
              << "library " << f.name << " " << digest(f, f.library) << "\n";
  }
}

TEST(Reproducible, HasTheSameBitsWithoutFusedOperations) {
  const std::string other =
      printed_without_fma("formats_base_tests", "Reproducible.DISABLED_PrintsDigests");
  int library_differs = 0;
  for (const Function& f : kFunctions) {
    const std::string name = f.name;
    EXPECT_NE(other.find("ours " + name + " " + digest(f, f.ours)), std::string::npos)
        << name;
    library_differs +=
        other.find("library " + name + " " + digest(f, f.library)) == std::string::npos;
  }
  if (library_differs == 0) {
    GTEST_SKIP() << "this processor or C library does not choose: nothing was compared";
  }
}

}  // namespace
}  // namespace palpate
