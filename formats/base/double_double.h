// Sums and products with twice a double's digits, without fused operations: a number is
// the unevaluated sum of two doubles.
//
// Dekker 1971 and Knuth (TAOCP 2, 4.2.2). The order of operations is that of
// SLEEF 3.5.1 (dd.h, Naoki Shibata and contributors, Boost Software License 1.0), whose
// functions' bits reproducible.h has. "Ordered" wants |x| >= |y|.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace palpate {

struct DoubleDouble {
  double high = 0.0;
  double low = 0.0;
  [[nodiscard]] double sum() const { return high + low; }
};

/// The upper 26 bits of a significand: products of two such are exact.
inline double upper_half(double x) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) & 0xfffffffff8000000u);
}

/// x with its sign turned where y is negative.
inline double times_sign(double x, double y) {
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) ^
                               (std::bit_cast<std::uint64_t>(y) & kSign));
}

/// To the nearest whole number, ties to even. @param x |x| < 2^31
inline std::int32_t nearest(double x) {
  const double away = x + (x > 0.0 ? 0.5 : -0.5);
  const auto odd = static_cast<std::uint64_t>(static_cast<std::int32_t>(away)) & 1u;
  return static_cast<std::int32_t>(
      std::bit_cast<double>(std::bit_cast<std::uint64_t>(away) - odd));
}

inline DoubleDouble operator-(DoubleDouble x) {
  return {-x.high, -x.low};
}
inline DoubleDouble scaled(DoubleDouble x, double power_of_two) {
  return {x.high * power_of_two, x.low * power_of_two};
}
inline DoubleDouble normalized(DoubleDouble x) {
  const double s = x.high + x.low;
  return {s, (x.high - s) + x.low};
}

inline DoubleDouble ordered_sum(double x, double y) {
  const double s = x + y;
  return {s, (x - s) + y};
}
inline DoubleDouble ordered_sum(DoubleDouble x, double y) {
  const double s = x.high + y;
  return {s, (x.high - s) + y + x.low};
}
inline DoubleDouble ordered_sum(double x, DoubleDouble y) {
  const double s = x + y.high;
  return {s, (x - s) + y.high + y.low};
}
inline DoubleDouble ordered_sum(DoubleDouble x, DoubleDouble y) {
  const double s = x.high + y.high;
  return {s, (x.high - s) + y.high + x.low + y.low};
}
inline DoubleDouble ordered_difference(DoubleDouble x, DoubleDouble y) {
  const double s = x.high - y.high;
  return {s, (((x.high - s) - y.high) + x.low) - y.low};
}

inline DoubleDouble exact_sum(double x, double y) {
  const double s = x + y;
  const double v = s - x;
  return {s, (x - (s - v)) + (y - v)};
}
inline DoubleDouble exact_sum(DoubleDouble x, double y) {
  const DoubleDouble s = exact_sum(x.high, y);
  return {s.high, s.low + x.low};
}
inline DoubleDouble exact_sum(double x, DoubleDouble y) {
  const DoubleDouble s = exact_sum(x, y.high);
  return {s.high, s.low + y.low};
}
inline DoubleDouble exact_sum(DoubleDouble x, DoubleDouble y) {
  const DoubleDouble s = exact_sum(x.high, y.high);
  return {s.high, s.low + (x.low + y.low)};
}

// h, l: upper and lower halves of the letter before.
inline DoubleDouble product(double x, double y) {
  const double xh = upper_half(x);
  const double xl = x - xh;
  const double yh = upper_half(y);
  const double yl = y - yh;
  const double s = x * y;
  return {s, xh * yh + -s + xl * yh + xh * yl + xl * yl};
}
inline DoubleDouble product(DoubleDouble x, double y) {
  const DoubleDouble s = product(x.high, y);
  return {s.high, s.low + x.low * y};
}
inline DoubleDouble product(DoubleDouble x, DoubleDouble y) {
  const DoubleDouble s = product(x.high, y.high);
  return {s.high, s.low + x.high * y.low + x.low * y.high};
}
/// Rounded to a double, smallest terms first.
inline double rounded_product(DoubleDouble x, DoubleDouble y) {
  const double xh = upper_half(x.high);
  const double xl = x.high - xh;
  const double yh = upper_half(y.high);
  const double yl = y.high - yh;
  return x.low * yh + xh * y.low + xl * yl + xh * yl + xl * yh + xh * yh;
}
inline DoubleDouble square(DoubleDouble x) {
  const double xh = upper_half(x.high);
  const double xl = x.high - xh;
  const double s = x.high * x.high;
  return {s, xh * xh + -s + (xh + xh) * xl + xl * xl + x.high * (x.low + x.low)};
}

/// 1 - d t, where t is nearly 1 / d.
inline double reciprocal_error(double d, double t) {
  const double dh = upper_half(d);
  const double dl = d - dh;
  const double th = upper_half(t);
  const double tl = t - th;
  return 1.0 - dh * th - dh * tl - dl * th - dl * tl;
}
inline DoubleDouble reciprocal(double d) {
  const double t = 1.0 / d;
  return {t, t * reciprocal_error(d, t)};
}
inline DoubleDouble reciprocal(DoubleDouble d) {
  const double t = 1.0 / d.high;
  return {t, t * (reciprocal_error(d.high, t) - d.low * t)};
}
inline DoubleDouble quotient(DoubleDouble n, DoubleDouble d) {
  const double t = 1.0 / d.high;
  const double th = upper_half(t);
  const double tl = t - th;
  const double nh = upper_half(n.high);
  const double nl = n.high - nh;
  const double s = n.high * t;
  const double u =
      (nh * th - s) + nh * tl + nl * th + nl * tl + s * reciprocal_error(d.high, t);
  return {s, t * (n.low - s * d.low) + u};
}
inline DoubleDouble square_root(double d) {
  const double t = std::sqrt(d);
  return scaled(product(exact_sum(d, product(t, t)), reciprocal(t)), 0.5);
}

}  // namespace palpate
