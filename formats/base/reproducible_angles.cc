// Sines, cosines, tangents and their inverses; where from: reproducible.cc.
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "formats/base/double_double.h"
#include "formats/base/estrin.h"
#include "formats/base/reproducible.h"

namespace palpate::reproducible {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr double kPerPi = 0.318309886183790671537767526745028724;
constexpr DoubleDouble kPi{3.141592653589793116, 1.2246467991473532072e-16};
// Pi in four parts, the last 28 bits of the first three zero.
constexpr double kPiParts[]{3.1415926218032836914, 3.1786509424591713469e-08,
                            1.2246467864107188502e-16, 1.2736634327021899816e-24};
constexpr double kFewTurns = 15.0;   // one product and one remainder will do
constexpr double kMostTurns = 1e14;  // four parts of pi will do
constexpr double kUpper = 1 << 24;   // the number of half turns: dh 2^24 + dl

double truncated(double x) {
  return static_cast<std::int32_t>(x);
}

// An angle less a number of turns.
struct Turned {
  DoubleDouble rest;
  std::int32_t quarter;  // the number, or its lowest bits
};

// s - (dh + dl) part of pi, where s has less the first part already.
DoubleDouble less_other_parts(DoubleDouble s, double dh, double dl, double part) {
  s = exact_sum(s, dh * (-kPiParts[1] * part));
  s = exact_sum(s, dl * (-kPiParts[1] * part));
  s = exact_sum(s, dh * (-kPiParts[2] * part));
  s = exact_sum(s, dl * (-kPiParts[2] * part));
  return ordered_sum(s, (dh + dl) * (-kPiParts[3] * part));
}

// Less q pi.
Turned less_half_turns(double x) {
  if (std::abs(x) < kFewTurns) {
    const double q = nearest(x * kPerPi);
    return {ordered_sum(q * -kPi.high + x, q * -kPi.low), static_cast<std::int32_t>(q)};
  }
  const double dh = truncated(x * (kPerPi / kUpper)) * kUpper;
  const double dl = nearest(x * kPerPi - dh);
  const DoubleDouble s = ordered_sum(dh * -kPiParts[0] + x, dl * -kPiParts[0]);
  return {less_other_parts(s, dh, dl, 1.0), static_cast<std::int32_t>(dl)};
}

// Less q pi / 2, q odd.
Turned less_odd_quarters(double x) {
  if (std::abs(x) < kFewTurns) {
    const double q = 2.0 * nearest(x * kPerPi + -0.5) + 1.0;
    const DoubleDouble s = exact_sum(x, q * (-kPi.high * 0.5));
    return {ordered_sum(s, q * (-kPi.low * 0.5)), static_cast<std::int32_t>(q)};
  }
  const double half = truncated(x * (kPerPi / (1 << 23)) + -kPerPi / kUpper);
  const double dl = 2.0 * nearest(x * kPerPi + (half * -(1 << 23) + -0.5)) + 1.0;
  const double dh = half * kUpper;
  const DoubleDouble s =
      exact_sum(dh * (-kPiParts[0] * 0.5) + x, dl * (-kPiParts[0] * 0.5));
  return {less_other_parts(s, dh, dl, 0.5), static_cast<std::int32_t>(dl)};
}

// Less q pi / 2.
Turned less_quarters(double x) {
  if (std::abs(x) < kFewTurns) {
    const double q = nearest(x * (2.0 * kPerPi));
    return {ordered_sum(q * (-kPi.high * 0.5) + x, q * (-kPi.low * 0.5)),
            static_cast<std::int32_t>(q)};
  }
  constexpr DoubleDouble kTwoPerPi{0.63661977236758138243, -3.9357353350364971764e-17};
  const double dh = truncated(x * (2.0 * kPerPi / kUpper)) * kUpper;
  const DoubleDouble turns =
      exact_sum(product(kTwoPerPi, x), (x < 0.0 ? -0.5 : 0.5) - dh);
  const double dl = truncated(turns.sum());
  const DoubleDouble s =
      ordered_sum(dh * (-kPiParts[0] * 0.5) + x, dl * (-kPiParts[0] * 0.5));
  return {less_other_parts(s, dh, dl, 0.5), static_cast<std::int32_t>(dl)};
}

// Sine of what less_half_turns() and less_odd_quarters() leave.
double sine_of_rest(DoubleDouble t) {
  static constexpr std::array kSeries{
      2.72052416138529567917983e-15, -7.6429259411395447190023e-13,
      1.60589370117277896211623e-10, -2.5052106814843123359368e-08,
      2.75573192104428224777379e-06, -0.000198412698412046454654947};
  const DoubleDouble s = square(t);
  const double u =
      estrin(kSeries, powers_of_two(s.high)) * s.high + 0.00833333333333318056201922;
  const DoubleDouble x = ordered_sum(
      1.0, product(ordered_sum(-0.166666666666666657414808, u * s.high), s));
  return rounded_product(t, x);
}

// @param y >= 0
DoubleDouble long_atan2(double y, double x) {
  static constexpr std::array kSeries{
      1.06298484191448746607415e-05, -0.000125620649967286867384336,
      0.00070557664296393412389774,  -0.00251865614498713360352999,
      0.00646262899036991172313504,  -0.0128281333663399031014274,
      0.0208024799924145797902497,   -0.0289002344784740315686289,
      0.0359785005035104590853656,   -0.041848579703592507506027,
      0.0470843011653283988193763,   -0.0524914210588448421068719,
      0.0587946590969581003860434,   -0.0666620884778795497194182,
      0.0769225330296203768654095,   -0.0909090442773387574781907};
  const double across = std::abs(x);
  const bool steep = across < y;
  const int quarters = (x < 0.0 ? -2 : 0) + (steep ? 1 : 0);
  const DoubleDouble s =
      steep ? quotient({-across, 0.0}, {y, 0.0}) : quotient({y, 0.0}, {across, 0.0});
  DoubleDouble t = normalized(square(s));
  double u = estrin(kSeries, powers_of_two(t.high));
  u = u * t.high + 0.111111108376896236538123;
  u = u * t.high + -0.142857142756268568062339;
  u = u * t.high + 0.199999999997977351284817;
  u = u * t.high + -0.333333333333317605173818;
  t = ordered_sum(s, product(product(s, t), u));
  constexpr DoubleDouble kQuarter{1.570796326794896557998982,
                                  6.12323399573676603586882e-17};
  return ordered_sum(product(kQuarter, static_cast<double>(quarters)), t);
}

}  // namespace

double sin(double x) {
  if (x == 0.0) {
    return x;
  }
  if (!(std::abs(x) < kMostTurns)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto [rest, q] = less_half_turns(x);
  const double u = sine_of_rest(rest);
  return (q & 1) != 0 ? -u : u;
}

double cos(double x) {
  if (!(std::abs(x) < kMostTurns)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto [rest, q] = less_odd_quarters(x);
  const double u = sine_of_rest(rest);
  return (q & 2) == 0 ? -u : u;
}

double tan(double x) {
  static constexpr std::array kSeries{
      +0.3245098826639276316e-3, +0.5619219738114323735e-3, +0.1460781502402784494e-2,
      +0.3591611540792499519e-2, +0.8863268409563113126e-2, +0.2186948728185535498e-1,
      +0.5396825399517272970e-1, +0.1333333333330500581e+0};
  if (x == 0.0) {
    return x;
  }
  if (!(std::abs(x) < kMostTurns)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto [rest, q] = less_quarters(x);
  const DoubleDouble t = scaled(rest, 0.5);
  const DoubleDouble s = square(t);
  const double u =
      estrin(kSeries, powers_of_two(s.high)) * s.high + 0.3333333333333343695e+0;
  DoubleDouble tangent = ordered_sum(t, product(product(s, t), u));  // of the half
  const DoubleDouble y = ordered_sum(-1.0, square(tangent));
  tangent = scaled(tangent, -2.0);
  return ((q & 1) != 0 ? quotient(-y, tangent) : quotient(tangent, y)).sum();
}

double acos(double x) {
  static constexpr std::array kSeries{
      +0.3161587650653934628e-1, -0.1581918243329996643e-1, +0.1929045477267910674e-1,
      +0.6606077476277170610e-2, +0.1215360525577377331e-1, +0.1388715184501609218e-1,
      +0.1735956991223614604e-1, +0.2237176181932048341e-1, +0.3038195928038132237e-1,
      +0.4464285681377102438e-1, +0.7500000000378581611e-1, +0.1666666666666497543e+0};
  const double a = std::abs(x);
  const bool small = a < 0.5;
  const double s2 = small ? x * x : (1.0 - a) * 0.5;
  const DoubleDouble s = a == 1.0 ? DoubleDouble{}
                         : small  ? DoubleDouble{a, 0.0}
                                  : square_root(s2);
  const double u = estrin(kSeries, powers_of_two(s2)) * (s2 * s.high);
  if (small) {
    return ordered_difference({kPi.high / 2.0, kPi.low / 2.0},
                              ordered_sum(times_sign(s.high, x), times_sign(u, x)))
        .sum();
  }
  const DoubleDouble y = scaled(ordered_sum(s, u), 2.0);
  return (x < 0.0 ? ordered_difference(kPi, y) : y).sum();
}

double atan2(double y, double x) {
  if (x != x || y != y) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  constexpr double kQuarter = std::numbers::pi / 2.0;
  if (std::abs(x) < 5.5626846462680083984e-309) {  // its reciprocal is infinite
    x *= 0x1p53;
    y *= 0x1p53;
  }
  const bool upright = std::abs(x) == kUnbounded || x == 0.0;
  double r = 0.0;
  if (y == 0.0) {
    r = std::signbit(x) ? std::numbers::pi : 0.0;
  } else if (std::abs(y) == kUnbounded) {
    r = kQuarter - (std::abs(x) == kUnbounded ? times_sign(kQuarter / 2.0, x) : 0.0);
  } else if (upright) {
    r = kQuarter - (x == 0.0 ? 0.0 : times_sign(kQuarter, x));
  } else {
    r = times_sign(long_atan2(std::abs(y), x).sum(), x);
  }
  return times_sign(r, y);
}

}  // namespace palpate::reproducible
