#include "runtime/paper/slow_value_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/account/rest_offset.h"

namespace palpate {
namespace {

// How much steeper than the response at x the curve may be elsewhere.
constexpr Real kSteepest = 3.0;
// A slope this little below zero is none.
constexpr Real kNegative = rounding(1e-12, 1e-5);

// Smallest of a + b s + c s^2 on [0, 1].
Real least(Real a, Real b, Real c) {
  const Real s = c != 0.0 ? std::clamp(-0.5 * b / c, 0.0, 1.0) : 0.0;
  return std::min({a, a + b + c, a + s * (b + s * c)});
}

bool sound(const LocalCurve& c, Real relative_slope) {
  const Real most = kSteepest * std::max(1.0, relative_slope);
  return c.length_m > 0.0 && least(c.a1, c.a2, c.a3) >= -kNegative &&
         least(-c.a1, -2.0 * c.a2, -3.0 * c.a3) >= -most;
}

LocalCurve line(const SlowValue& slow) {
  const Real f = slow.f_n;
  const Real k = std::max(slow.k_n_per_m, f * f / (2.0 * slow.energy_j));
  return {.end_m = slow.x_m, .length_m = f / k, .force_n = f, .k_n_per_m = k};
}

// The cubic, moved by shift_m, and its continuation.
CurvePoint cubic_at(const LocalCurve& c, Real x_m) {
  const Real past = x_m - c.shift_m - c.end_m;
  const Real s = c.length_m > 0.0 ? std::min(1.0 + past / c.length_m, 1.0) : 0.0;
  if (!(s > 0.0)) {
    return {};
  }
  const Real force = std::max(0.0, c.force_n * s * (c.a1 + s * (c.a2 + s * c.a3)));
  const Real energy =
      std::max(0.0, c.force_n * c.length_m * s * s *
                        (c.a1 / 2.0 + s * (c.a2 / 3.0 + s * c.a3 / 4.0)));
  if (!(past > 0.0)) {
    const Real slope =
        c.force_n / c.length_m * (c.a1 + s * (2.0 * c.a2 + s * 3.0 * c.a3));
    return {force, slope, energy};
  }
  // The slope goes from k to its last value over `bent`, then stays.
  const Real k = c.k_n_per_m;
  const Real b = c.bend_n_per_m2;
  const Real last = b > 0.0 ? kSteepest * k : 0.0;
  const Real bent = b != 0.0 ? std::min(past, (last - k) / b) : past;
  const Real at_bent = force + (k + 0.5 * b * bent) * bent;
  const Real energy_bent = energy + (force + (k / 2.0 + b * bent / 6.0) * bent) * bent;
  const Real rest = past - bent;
  const Real slope = k + b * bent;
  return {at_bent + slope * rest, slope,
          energy_bent + (at_bent + 0.5 * slope * rest) * rest};
}

// What a straight line through the point stores.
Real tangent_j(const CurvePoint& point) {
  return point.stiffness_n_per_m > 0.0
             ? point.force_n * point.force_n / (2.0 * point.stiffness_n_per_m)
             : std::numeric_limits<Real>::infinity();
}

void set_tangent(LocalCurve& curve, const CurvePoint& point, Real blend) {
  curve.blend = point.stiffness_n_per_m > 0.0 ? blend : 0.0;
  curve.tangent_n = point.force_n;
  curve.tangent_n_per_m = point.stiffness_n_per_m;
}

}  // namespace

LocalCurve local_curve(const SlowValue& slow) noexcept {
  LocalCurve curve{.end_m = slow.x_m,
                   .length_m = slow.x_m - slow.touch_m,
                   .force_n = slow.f_n,
                   .k_n_per_m = std::max(0.0, slow.k_n_per_m)};
  const Real work = slow.f_n * curve.length_m;
  const Real slope = slow.k_n_per_m * curve.length_m / slow.f_n;
  curve.a3 = 12.0 * slow.energy_j / work - 8.0 + 2.0 * slope;
  curve.a2 = slope - 1.0 - 2.0 * curve.a3;
  curve.a1 = 2.0 - slope + curve.a3;
  if (!sound(curve, slope)) {
    return line(slow);
  }
  curve.bend_n_per_m2 =
      slow.f_n * (2.0 * curve.a2 + 6.0 * curve.a3) / (curve.length_m * curve.length_m);
  return curve;
}

void lower(LocalCurve& curve, Real allowed_j) noexcept {
  const CurvePoint whole = cubic_at(curve, curve.end_m);
  if (whole.energy_j <= allowed_j) {
    return;
  }
  const Real line_j = tangent_j(whole);
  if (line_j <= allowed_j) {
    set_tangent(curve, whole, (whole.energy_j - allowed_j) / (whole.energy_j - line_j));
    return;
  }
  const auto at_shift = [&](Real shift_m) {
    curve.shift_m = shift_m;
    const CurvePoint point = cubic_at(curve, curve.end_m);
    const Real held = std::min(point.energy_j, tangent_j(point));
    return ShiftedEnergy{shift_m, held, point.force_n};
  };
  curve.shift_m = raised_shift_m({0.0, std::min(whole.energy_j, line_j), whole.force_n},
                                 curve.length_m, allowed_j, at_shift);
  const CurvePoint point = cubic_at(curve, curve.end_m);
  set_tangent(curve, point, tangent_j(point) < point.energy_j ? 1.0 : 0.0);
}

CurvePoint at(const LocalCurve& c, Real x_m) noexcept {
  CurvePoint point = cubic_at(c, x_m);
  if (!(c.blend > 0.0)) {
    return point;
  }
  const Real k = c.tangent_n_per_m;
  const Real line_n = std::max(0.0, c.tangent_n + k * (x_m - c.end_m));
  if (x_m >= c.end_m) {
    const CurvePoint end = cubic_at(c, c.end_m);
    point.energy_j -= c.blend * (end.energy_j - tangent_j(end));
    return point;
  }
  const Real rest = 1.0 - c.blend;
  return {rest * point.force_n + c.blend * line_n,
          rest * point.stiffness_n_per_m + (line_n > 0.0 ? c.blend * k : 0.0),
          rest * point.energy_j + c.blend * line_n * line_n / (2.0 * k)};
}

}  // namespace palpate
