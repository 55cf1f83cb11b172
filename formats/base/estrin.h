// Polynomials by Estrin's scheme: the order of operations is stated, and short.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <span>

namespace palpate {

/// x, x^2, x^4, x^8.
using PowersOfTwo = std::array<double, 4>;

inline PowersOfTwo powers_of_two(double x) {
  const double x2 = x * x;
  const double x4 = x2 * x2;
  return {x, x2, x4, x4 * x4};
}

/// @param c N coefficients, the highest power's first, 1 <= N <= 16
template <std::size_t N>
constexpr double estrin(std::span<const double, N> c, const PowersOfTwo& x) {
  if constexpr (N == 1) {
    return c[0];
  } else {
    constexpr std::size_t kLow = std::bit_floor(N - 1);
    return x[std::bit_width(kLow) - 1] * estrin(c.template first<N - kLow>(), x) +
           estrin(c.template last<kLow>(), x);
  }
}

template <std::size_t N>
constexpr double estrin(const std::array<double, N>& c, const PowersOfTwo& x) {
  return estrin(std::span(c), x);
}

}  // namespace palpate
