// Laws have the same bits on processors with and without fused operations.
#include <cmath>
#include <iostream>
#include <random>

#include <gtest/gtest.h>

#include "formats/base/sha256.h"
#include "tests/support/every_law.h"
#include "tests/support/other_processor.h"

namespace palpate {
namespace {

std::string digest(const NamedLaw& named, bool by_library) {
  constexpr double kLargest = 0.25;
  std::mt19937_64 random(11);
  Sha256 sum;
  const auto add = [&](const double* values, std::size_t count) {
    sum.update(std::as_bytes(std::span(values, count)));
  };
  for (int i = 0; i < 3000; ++i) {
    Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
    for (double& entry : F.reshaped()) {
      entry += kLargest * (static_cast<double>(random() >> 11) * 0x1p-52 - 1.0);
    }
    const LocalResponse at = response(named.law, F);
    add(&at.energy_density, 1);
    add(at.stress.data(), 9);
    add(at.tangent.data(), 81);
    if (by_library) {
      const double power = std::pow(std::exp(F(0, 0)), std::log(F(1, 1)));
      add(&power, 1);
    }
  }
  return named.name + (by_library ? " by library " : " ") + sum.hex();
}

// What the next test runs in a process of its own.
TEST(LawBits, DISABLED_PrintsDigests) {
  for (const NamedLaw& named : every_law()) {
    std::cout << digest(named, false) << "\n" << digest(named, true) << "\n";
  }
}

TEST(LawBits, AreTheSameWithoutFusedOperations) {
  const std::string other = printed_without_fma("precompute_material_tests",
                                                "LawBits.DISABLED_PrintsDigests");
  bool library_differs = false;
  for (const NamedLaw& named : every_law()) {
    EXPECT_NE(other.find(digest(named, false)), std::string::npos) << named.name;
    library_differs |= other.find(digest(named, true)) == std::string::npos;
  }
  if (!library_differs) {
    GTEST_SKIP() << "this processor or C library does not choose: nothing was compared";
  }
}

}  // namespace
}  // namespace palpate
