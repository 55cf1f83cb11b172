// Sudden falls of a force during an insertion: ruptures, separated from noise.
//
//   T_m(i) = (mean of F(i-m+1 .. i) - mean of F(i+1 .. i+m)) / s_m,   m = 1, 2, 4, 8
//
// Symbols: F force [N], s_m standard deviation of the difference of means. s_m is
// robust and measured on the force itself, whatever the noise's autocorrelation: from
// differences of T_m between places 2 m samples apart. The force of an insertion never
// falls between ruptures, so that T_m has no positive mean there. A fall is taken where
// T_m exceeds the quantile of Student's t that all places and all m exceed together
// with the stated probability (Bonferroni).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace palpate {

struct ForceFall {
  std::size_t before = 0;   ///< last sample before the fall
  std::size_t after = 0;    ///< first sample after it; between them the force falls
  double deviations = 0.0;  ///< [-] T_m
};

/// Probability that noise alone gives a fall somewhere in one insertion.
constexpr double kFalseFallRate = 1e-3;
constexpr std::size_t kFallReach = 8;  ///< [samples] the largest m

/// One-sided normal quantile: exceeded with this probability, which is below 0.5.
[[nodiscard]] double normal_quantile_above(double probability);

/// Falls in order. @param force_n (n) of an insertion, in a row. None where n < 40.
[[nodiscard]] std::vector<ForceFall> find_force_falls(
    std::span<const double> force_n, double false_rate = kFalseFallRate);

}  // namespace palpate
