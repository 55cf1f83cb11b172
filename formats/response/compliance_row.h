// How far a body's surface moves at one contact for a force at another. A row of
// numbers over the distance between the contacts states it. Header only, no allocation,
// for the fast step too.
//
// The row of a place holds v_k = c(r_k) r_k [m^2/N] at K knots r_k, evenly spaced in ln
// r. c(r) [m/N] is the inward normal displacement at distance r for 1 N there. Two
// contacts i and j at distance r couple by
//
//   C_ij = (c_i(r) + c_j(r)) / 2 + sum_m s_m b_im b_jm,
//
// b_m [m^1/2 N^-1/2] modes by which parts of the body move as a whole, whatever the
// distance (a lobe that tilts). s_m = 1 for the first added_modes, -1 for the rest.
//
// Between knots v is the cubic in ln r through the knots (Catmull-Rom). The cubic's
// slopes are (v_{k+1} - v_{k-1}) / 2 a step, at the first knot v_1 - v_0, at the
// last 0. So c has a continuous slope, and is linear in the row: rows that are blended
// over a triangle give blended compliances. Beyond the last knot v is constant, c falls
// as 1/r. Below the first one c = c_0 + c_0' (r^2 - r_0^2) / (2 r_0): value and slope
// go on, and the slope is 0 where two contacts coincide. On a half-space, v constant,
// it rises to 1.5 c_0.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

namespace palpate {

inline constexpr std::size_t kFewestKnots = 4;
inline constexpr std::size_t kMostKnots = 32;
inline constexpr std::size_t kMostModes = 16;

/// Distances of a row's numbers: first_m exp(k log_step), k < count.
struct ComplianceKnots {
  double first_m = 0.0;   ///< [m] > 0
  double log_step = 0.0;  ///< [-] > 0
  std::size_t count = 0;  ///< [4, 32]; 0: there are none
};

/// c and dc/dr.
struct ComplianceSample {
  double compliance_m_per_n = 0.0;  ///< [m/N]
  double slope_per_n = 0.0;         ///< [1/N]
};

/// What c at one distance takes of a row: the same for all rows, so that of a rigid
/// tool it is found once.
struct ComplianceWeights {
  std::size_t first = 0;          ///< knot of the first weight
  std::array<double, 4> value{};  ///< [1/m] c = sum of value[k] row[first + k]
  std::array<double, 4> slope{};  ///< [1/m^2] dc/dr likewise

  /// @param row (count of knots) [m^2/N]
  template <typename Row>
  [[nodiscard]] ComplianceSample of(const Row& row) const noexcept {
    ComplianceSample sample;
    for (std::size_t k = 0; k < value.size(); ++k) {
      const auto v = static_cast<double>(row[first + k]);
      sample.compliance_m_per_n += value[k] * v;
      sample.slope_per_n += slope[k] * v;
    }
    return sample;
  }
};

/// ln x, to a relative 4.5e-16 or to 1e-16, whichever is more. The operations round
/// alike on every processor, which the C library's logarithm does not. @param x [-] > 0
/// and not denormal; what is not finite gives itself.
[[nodiscard]] inline double arithmetic_log(double x) noexcept {
  if (!std::isfinite(x)) {
    return x;
  }
  // x = m 2^e; ln m = 2 artanh s, |s| < 0.172, whose series ends below 1e-18.
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < 0.5 * std::numbers::sqrt2) {
    m *= 2.0;
    --exponent;
  }
  constexpr std::array<double, 10> kTerm{1.0 / 3.0,  1.0 / 5.0,  1.0 / 7.0,  1.0 / 9.0,
                                         1.0 / 11.0, 1.0 / 13.0, 1.0 / 15.0, 1.0 / 17.0,
                                         1.0 / 19.0, 1.0 / 21.0};
  const double s = (m - 1.0) / (m + 1.0);
  double series = 0.0;
  for (std::size_t k = kTerm.size(); k-- > 0;) {
    series = s * s * (kTerm[k] + series);
  }
  return static_cast<double>(exponent) * std::numbers::ln2 + 2.0 * (s + s * series);
}

/// Weights within an interval between knots. @param interval below count - 1.
/// @param t [-] [0, 1] in it. @param r [m] the distance that it is.
[[nodiscard]] inline ComplianceWeights weights_between(const ComplianceKnots& knots,
                                                       std::size_t interval, double t,
                                                       double r) noexcept {
  ComplianceWeights weights;
  weights.first = std::min(interval - std::min<std::size_t>(interval, 1),
                           knots.count - weights.value.size());
  std::array<double, 4> v{};        // v(t) = sum v[k] row[first + k]
  std::array<double, 4> v_slope{};  // dv/dt
  // Hermite's polynomials and their derivatives: of both values, of both slopes.
  const double rise = t * t * (3.0 - 2.0 * t);
  const double rise_slope = 6.0 * t * (1.0 - t);
  const auto add = [&](std::size_t knot, double weight, double weight_slope) {
    v[knot - weights.first] += weight;
    v_slope[knot - weights.first] += weight_slope;
  };
  add(interval, 1.0 - rise, -rise_slope);
  add(interval + 1, rise, rise_slope);
  const auto add_tangent = [&](std::size_t knot, double weight, double weight_slope) {
    if (knot + 1 == knots.count) {
      return;
    }
    const std::size_t before = knot == 0 ? 0 : knot - 1;
    const double share = 1.0 / static_cast<double>(knot + 1 - before);
    add(knot + 1, share * weight, share * weight_slope);
    add(before, -share * weight, -share * weight_slope);
  };
  add_tangent(interval, t * (1.0 - t) * (1.0 - t), (1.0 - t) * (1.0 - 3.0 * t));
  add_tangent(interval + 1, t * t * (t - 1.0), t * (3.0 * t - 2.0));
  for (std::size_t k = 0; k < v.size(); ++k) {
    weights.value[k] = v[k] / r;
    weights.slope[k] = (v_slope[k] / knots.log_step - v[k]) / (r * r);
  }
  return weights;
}

/// @param knots that there are. @param distance_m [m] >= 0; NaN gives NaN.
[[nodiscard]] inline ComplianceWeights compliance_weights(const ComplianceKnots& knots,
                                                          double distance_m) noexcept {
  const double r = distance_m;
  if (r < knots.first_m) {
    ComplianceWeights weights = weights_between(knots, 0, 0.0, knots.first_m);
    const double ratio = r / knots.first_m;
    for (std::size_t k = 0; k < weights.value.size(); ++k) {
      const double slope = weights.slope[k];
      weights.value[k] += 0.5 * slope * knots.first_m * (ratio * ratio - 1.0);
      weights.slope[k] = slope * ratio;
    }
    return weights;
  }
  const double step = arithmetic_log(r / knots.first_m) / knots.log_step;
  const auto last = static_cast<double>(knots.count - 1);
  if (step >= last) {
    ComplianceWeights weights;
    weights.first = knots.count - weights.value.size();
    weights.value.back() = 1.0 / r;
    weights.slope.back() = -1.0 / (r * r);
    return weights;
  }
  const std::size_t interval = step >= 0.0 ? static_cast<std::size_t>(step) : 0;
  return weights_between(knots, interval, step - static_cast<double>(interval), r);
}

/// c and dc/dr of one row. @param row (count of knots) [m^2/N]
template <typename Row>
[[nodiscard]] ComplianceSample compliance_at(const ComplianceKnots& knots,
                                             const Row& row,
                                             double distance_m) noexcept {
  return compliance_weights(knots, distance_m).of(row);
}

/// What modes add to C of two places. @param one, other (any) [m^1/2 N^-1/2] with as
/// many numbers. @param added how many of them add; the rest subtracts.
template <typename Row>
[[nodiscard]] double coupling_by_modes(const Row& one, const Row& other,
                                       std::size_t count, std::size_t added) noexcept {
  double sum = 0.0;
  for (std::size_t m = 0; m < count; ++m) {
    const double part = static_cast<double>(one[m]) * static_cast<double>(other[m]);
    sum += m < added ? part : -part;
  }
  return sum;
}

}  // namespace palpate
