// The algorithms and coefficients are those of SLEEF 3.5.1 (sleefsimddp.c, Naoki
// Shibata and contributors, Boost Software License 1.0), for one double and without
// fused operations: the bits of its Sleef_cinz_*d1_u10purec.
#include "formats/base/reproducible.h"

#include <cstdint>
#include <limits>
#include <span>

#include "formats/base/double_double.h"
#include "formats/base/estrin.h"
#include "formats/base/long_exp.h"

namespace palpate::reproducible {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kLargestExponent = 709.78271114955742909217217426;      // log(DBL_MAX)
constexpr double kHalfLn2 = .69314718055966295651160180568695068359375;  // upper part
constexpr double kRestLn2 = .28235290563031577122588448175013436025525412068e-12;
constexpr double kPerLn2 = 1.442695040888963407359924681001892137;
constexpr DoubleDouble kLn2{0.693147180559945286226764, 2.319046813846299558417771e-17};

constexpr int kMantissaBits = 52;
constexpr int kExponentBias = 0x3ff;

double power_of_two(int exponent) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(kExponentBias + exponent)
                               << kMantissaBits);
}

// By two factors: the result may be subnormal or infinite.
double scaled_by_power(double x, int exponent) {
  return x * power_of_two(exponent >> 1) * power_of_two(exponent - (exponent >> 1));
}

int exponent_bits(double x) {
  return static_cast<int>((std::bit_cast<std::uint64_t>(x) >> kMantissaBits) & 0x7ff);
}

// floor(log2(|x|)), also of subnormal numbers.
int exponent_of(double x) {
  constexpr double kSmall = 4.9090934652977266E-91;  // 2^-300
  const double magnitude = std::abs(x);
  return magnitude < kSmall
             ? exponent_bits(2.037035976334486E90 * magnitude) - (300 + kExponentBias)
             : exponent_bits(magnitude) - kExponentBias;
}

// x = m 2^e, 3/4 <= m < 3/2. @param x >= 0
struct Scientific {
  double m;
  int e;
};

Scientific scientific(double x) {
  const bool subnormal = x < std::numeric_limits<double>::min();
  const double normal = subnormal ? x * 0x1p64 : x;
  const int e = exponent_bits(normal * (1.0 / 0.75)) - kExponentBias;
  const double m =
      std::bit_cast<double>(std::bit_cast<std::uint64_t>(normal) -
                            (static_cast<std::uint64_t>(e) << kMantissaBits));
  return {m, subnormal ? e - 64 : e};
}

// log(2^e (1 + x) / (1 - x)), 2 atanh(x) by its series. @param x |x| <= 1/5
double log_of_quotient(int e, DoubleDouble x) {
  static constexpr std::array kSeries{
      0.1532076988502701353e+0, 0.1525629051003428716e+0, 0.1818605932937785996e+0,
      0.2222214519839380009e+0, 0.2857142932794299317e+0, 0.3999999999635251990e+0,
      0.6666666666667333541e+0};
  const double x2 = x.high * x.high;
  DoubleDouble s = product(kLn2, static_cast<double>(e));
  s = ordered_sum(s, scaled(x, 2.0));
  s = ordered_sum(s, x2 * x.high * estrin(kSeries, powers_of_two(x2)));
  return s.sum();
}

// log(d) with twice the digits. @param d > 0
DoubleDouble long_log(double d) {
  static constexpr std::array kSeries{
      0.116255524079935043668677, 0.103239680901072952701192,
      0.117754809412463995466069, 0.13332981086846273921509,
      0.153846227114512262845736, 0.181818180850050775676507,
      0.222222222230083560345903, 0.285714285714249172087875,
      0.400000000000000077715612};
  constexpr DoubleDouble kTwoThirds{0.666666666666666629659233,
                                    3.80554962542412056336616e-17};
  const auto [m, e] = scientific(d);
  DoubleDouble x = quotient(exact_sum(-1.0, m), exact_sum(1.0, m));
  const DoubleDouble x2 = square(x);
  const double t = estrin(kSeries, powers_of_two(x2.high));
  DoubleDouble s = product(kLn2, static_cast<double>(e));
  s = ordered_sum(s, scaled(x, 2.0));
  x = product(x2, x);
  s = ordered_sum(s, product(x, kTwoThirds));
  x = product(x2, x);
  return ordered_sum(s, product(x, t));
}

// d = q ln 2 + rest.
struct Reduced {
  DoubleDouble rest;
  int q;
};

Reduced without_powers_of_two(DoubleDouble d) {
  const int q = nearest(d.sum() * kPerLn2);
  const double n = q;
  return {exact_sum(exact_sum(d, n * -kHalfLn2), n * -kRestLn2), q};
}

// exp(d). @param d [-1000, 710]
double exp_of_long(DoubleDouble d) {
  static constexpr std::array kSeries{
      2.51069683420950419527139e-08, 2.76286166770270649116855e-07,
      2.75572496725023574143864e-06, 2.48014973989819794114153e-05,
      0.000198412698809069797676111, 0.0013888888939977128960529,
      0.00833333333332371417601081,  0.0416666666665409524128449,
      0.166666666666666740681535,    0.500000000000000999200722};
  const auto [rest, q] = without_powers_of_two(d);
  const DoubleDouble s = normalized(rest);
  const double u = estrin(kSeries, powers_of_two(s.high));
  const DoubleDouble t = ordered_sum(ordered_sum(1.0, s), product(square(s), u));
  return scaled_by_power(t.sum(), q);
}

}  // namespace

DoubleDouble long_exp(DoubleDouble d) {
  static constexpr std::array kSeries{
      0.1602472219709932072e-9, 0.2092255183563157007e-8, 0.2505230023782644465e-7,
      0.2755724800902135303e-6, 0.2755731892386044373e-5, 0.2480158735605815065e-4,
      0.1984126984148071858e-3, 0.1388888888886763255e-2, 0.8333333333333347095e-2,
      0.4166666666666669905e-1};
  const auto [s, q] = without_powers_of_two(d);
  const DoubleDouble s2 = square(s);
  const DoubleDouble s4 = square(s2);
  const double u = estrin(kSeries, {s.high, s2.high, s4.high, s4.high * s4.high});
  DoubleDouble t = ordered_sum(0.5, product(s, 0.1666666666666666574e+0));
  t = ordered_sum(1.0, product(t, s));
  t = ordered_sum(1.0, product(t, s));
  t = ordered_sum(t, product(s4, u));
  return {scaled_by_power(t.high, q), scaled_by_power(t.low, q)};
}

double exp(double x) {
  static constexpr std::array kSeries{
      2.08860621107283687536341e-09, 2.51112930892876518610661e-08,
      2.75573911234900471893338e-07, 2.75572362911928827629423e-06,
      2.4801587159235472998791e-05,  0.000198412698960509205564975,
      0.00138888888889774492207962,  0.00833333333331652721664984,
      0.0416666666666665047591422,   0.166666666666666851703837};
  if (!(x <= kLargestExponent)) {
    return x + kInfinity;  // NaN stays
  }
  if (x < -1000.0) {
    return 0.0;
  }
  const int q = nearest(x * kPerLn2);
  const double n = q;
  double s = n * -kHalfLn2 + x;
  s = n * -kRestLn2 + s;
  const double u = estrin(kSeries, powers_of_two(s)) * s + 0.5;
  return scaled_by_power(1.0 + (s * s * u + s), q);
}

double expm1(double x) {
  if (!(x <= 709.782712893383996732223)) {
    return x + kInfinity;
  }
  if (x < -36.736800569677101399113302437) {
    return -1.0;
  }
  if (x == 0.0) {
    return x;
  }
  return exact_sum(long_exp({x, 0.0}), -1.0).sum();
}

double log(double x) {
  if (!(x > 0.0)) {
    return x == 0.0 ? -kInfinity : kNan;
  }
  if (x == kInfinity) {
    return x;
  }
  const auto [m, e] = scientific(x);
  return log_of_quotient(e, quotient(exact_sum(-1.0, m), exact_sum(1.0, m)));
}

double log1p(double x) {
  if (!(x > -1.0)) {
    return x == -1.0 ? -kInfinity : kNan;
  }
  if (x > 1e+307) {
    return kInfinity;
  }
  if (x == 0.0) {
    return x;
  }
  const int e = scientific(x + 1.0).e;
  const double t = power_of_two(-e);
  const double m = x * t + (t - 1.0);
  return log_of_quotient(e, quotient({m, 0.0}, ordered_sum(2.0, m)));
}

double pow(double x, double y) {
  if (y == 0.0 || x == 1.0) {
    return 1.0;
  }
  if (x != x || y != y) {
    return kNan;
  }
  constexpr double kAllEven = 0x1p53;
  const bool large = std::abs(y) > kAllEven;
  const auto whole = static_cast<std::int64_t>(large ? 0.0 : y);
  const bool y_is_odd = !large && static_cast<double>(whole) == y && (whole & 1) != 0;
  const bool y_is_whole = large || static_cast<double>(whole) == y;
  if (std::abs(x) == kInfinity || x == 0.0) {
    const bool vanishes = (x == 0.0 ? -y : y) < 0.0;
    return (y_is_odd ? times_sign(1.0, x) : 1.0) * (vanishes ? 0.0 : kInfinity);
  }
  if (std::abs(y) == kInfinity) {
    const double growth = times_sign(std::abs(x) - 1.0, y);
    return growth < 0.0 ? 0.0 : growth == 0.0 ? 1.0 : kInfinity;
  }
  const DoubleDouble d = product(long_log(std::abs(x)), y);
  const double magnitude = d.high > kLargestExponent ? kInfinity
                           : d.high < -1000.0        ? 0.0
                                                     : exp_of_long(d);
  return magnitude * (x > 0.0 ? 1.0 : y_is_whole ? (y_is_odd ? -1.0 : 1.0) : kNan);
}

double cbrt(double x) {
  constexpr DoubleDouble kRoots[]{{1.0, 0.0},  // of 2^0, 2^1, 2^2
                                  {1.2599210498948731907, -2.5899333753005069177e-17},
                                  {1.5874010519681995834, -1.0869008194197822986e-16}};
  if (!(std::abs(x) > 0.0) || std::abs(x) == kInfinity) {
    return x;
  }
  const int e = exponent_of(x) + 1;
  const int thirds = (e + 6144) / 3;
  const DoubleDouble root = kRoots[(e + 6144) % 3];
  const double d = std::abs(scaled_by_power(x, -e));
  double r = -0.640245898480692909870982;  // d^(-1/3)
  r = r * d + 2.96155103020039511818595;
  r = r * d + -5.73353060922947843636166;
  r = r * d + 6.03990368989458747961407;
  r = r * d + -3.85841935510444988821632;
  r = r * d + 2.2307275302496609725722;
  const double r4 = r * r * (r * r);
  r = r - (d * r4 - r) * (1.0 / 3.0);  // Newton's step
  DoubleDouble u = product(r, r);
  u = exact_sum(product(product(u, u), d), -r);
  const double step = -2.0 / 3.0 * u.sum() * r;
  DoubleDouble v = product(exact_sum(product(r, r), step), d);
  v = product(v, {times_sign(root.high, x), times_sign(root.low, x)});
  return scaled_by_power(v.sum(), thirds - 2048);
}

double tanh(double x) {
  if (!(std::abs(x) <= 18.714973875)) {
    return x != x ? x : times_sign(1.0, x);
  }
  const DoubleDouble d = long_exp({std::abs(x), 0.0});
  const DoubleDouble e = reciprocal(d);
  return times_sign(quotient(exact_sum(d, -e), exact_sum(d, e)).sum(), x);
}

}  // namespace palpate::reproducible
