#include "formats/stored/storage_options.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/said.h"

namespace palpate {
namespace {

TEST(StorageOptions, EveryPrecisionIsFoundByItsName) {
  for (const Precision precision :
       {Precision::kFloat64, Precision::kFloat32, Precision::kInt16}) {
    EXPECT_EQ(precision_of(name_of(precision)), precision);
  }
  EXPECT_STREQ(name_of(Precision::kFloat64), "float64");
  EXPECT_STREQ(name_of(Precision::kFloat32), "float32");
  EXPECT_STREQ(name_of(Precision::kInt16), "int16");
}

TEST(StorageOptions, OtherNamesAreRefusedWithThoseThatThereAre) {
  EXPECT_EQ(refusal([] {
              (void)precision_of("Float64");
            }),
            "unknown precision \"Float64\"; there are: float64, float32, int16");
  EXPECT_THROW((void)precision_of(""), InputError);
  const std::string flood = refusal([] {
    (void)precision_of(std::string(9999, 'x'));
  });
  expect_says(flood, std::string(80, 'x'));
  EXPECT_FALSE(contains(flood, std::string(81, 'x')));
}

// Largest values whose quotient by 32767 rounds down, up, and not at all.
std::vector<double> largest_values() {
  std::vector<double> values{kInt16Steps, 2.0 * kInt16Steps, 1.0, 3.0, 1e-40, 1e-44,
                             1e30};
  for (double v = 1e-9; v < 1e3; v *= 1.37) {
    values.push_back(v);
  }
  return values;
}

TEST(StorageOptions, AScaleCountsItsLargestValueWithinTheSteps) {
  for (const double largest : largest_values()) {
    const double scale = int16_scale(std::vector<double>{0.0, largest, 0.5 * largest});
    EXPECT_LE(largest / scale, kInt16Steps) << largest;
  }
}

TEST(StorageOptions, AScaleIsTheLeastFloatThatDoes) {
  for (const double largest : largest_values()) {
    const double scale = int16_scale(std::vector<double>{largest});
    const auto stored = static_cast<float>(scale);
    EXPECT_EQ(static_cast<double>(stored), scale) << largest;
    const auto below = static_cast<double>(std::nextafter(stored, 0.0F));
    EXPECT_LT(below, largest / kInt16Steps) << largest;
  }
}

TEST(StorageOptions, AnExactQuotientIsTheScale) {
  EXPECT_EQ(int16_scale(std::vector<double>{kInt16Steps}), 1.0);
  EXPECT_EQ(int16_scale(std::vector<double>{0.25 * kInt16Steps, 1.0}), 0.25);
}

TEST(StorageOptions, ANodeWithoutValuesOrWithZerosHasNoScale) {
  EXPECT_EQ(int16_scale({}), 0.0);
  EXPECT_EQ(int16_scale(std::vector<double>{0.0, 0.0}), 0.0);
}

// What is stored once is stored again as it was: k scale is exact in double precision.
TEST(StorageOptions, RoundingTwiceIsRoundingOnce) {
  for (const double largest : largest_values()) {
    const double scale = int16_scale(std::vector<double>{largest});
    for (const double steps : {1.0, 2.0, 3.0, 12345.0, kInt16Steps}) {
      const double read = steps * scale;
      EXPECT_EQ(std::fma(steps, scale, -read), 0.0) << largest;
      EXPECT_EQ(std::round(read / scale), steps) << largest;
    }
  }
}

}  // namespace
}  // namespace palpate
