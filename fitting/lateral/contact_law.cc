#include "fitting/lateral/contact_law.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr int kRootSteps = 60;
constexpr double kPartialSlipReach = 1.5;  // x_s over x_p

// y in [0, 1] of u = x_s (1 - y^2) + e (1 - y^3), 0 < u < x_s + e, by Newton's method.
// The right side falls and is concave in y: after the first step all stay above the
// root.
double stuck_radius(double u, double x_s, double e) noexcept {
  double y = std::sqrt(std::max(0.0, 1.0 - u / (x_s + e)));
  for (int i = 0; i < kRootSteps; ++i) {
    const double misses = x_s * (1.0 - y * y) + e * (1.0 - y * y * y) - u;
    const double step = misses / (2.0 * x_s * y + 3.0 * e * y * y);
    y = std::clamp(y + step, 0.0, 1.0);
    if (!(std::abs(step) > 1e-16)) {
      break;
    }
  }
  return y;
}

// With c = S/k + S/k_i: g = u / c, dg/dln S = -g, dg/dln k = g (S/k) / c.
CurveShare sharp_share(const ContactCurve& curve, double u) noexcept {
  const double reach = curve.slides_at_m(), g = u / reach;
  return {g, 1.0 / reach, g * curve.presliding_m() / reach, -g};
}

// y = (1 - u_c/x_s)^(1/2), g = 1 - y^3, e = S/k_i, du/dy = -(2 x_s y + 3 e y^2). At
// constant u dg/dx_s = -3 y (1 - y^2) / (2 x_s + 3 e y). x_s falls as 1/k. g depends on
// u / S alone for given k, therefore dg/dln S = -u dg/du.
CurveShare partial_share(const ContactCurve& curve, double u) noexcept {
  const double x_s = kPartialSlipReach * curve.presliding_m();
  const double e = curve.slip_force_n / curve.instrument_n_per_m;
  const double y = stuck_radius(u, x_s, e), below = 2.0 * x_s + 3.0 * e * y;
  const double by_u = 3.0 * y / below;
  return {1.0 - y * y * y, by_u, x_s * 3.0 * y * (1.0 - y * y) / below, -u * by_u};
}

}  // namespace

std::string_view law_name(ContactLaw law) noexcept {
  return law == ContactLaw::kSharpSlip ? "sharp slip" : "partial slip";
}

double ContactCurve::slides_at_m() const noexcept {
  const double reach = law == ContactLaw::kSharpSlip ? 1.0 : kPartialSlipReach;
  return reach * presliding_m() + slip_force_n / instrument_n_per_m;
}

CurveShare force_share(const ContactCurve& curve, double u_m) noexcept {
  if (u_m >= curve.slides_at_m()) {
    return {.value = 1.0};
  }
  return curve.law == ContactLaw::kSharpSlip ? sharp_share(curve, u_m)
                                             : partial_share(curve, u_m);
}

double loop_loss_j(const ContactCurve& curve, double amplitude_m) noexcept {
  // The instrument takes its share of the amplitude and loses nothing.
  const double q = curve.slip_force_n * force_share(curve, amplitude_m).value;
  const double x = amplitude_m - q / curve.instrument_n_per_m;
  const double s = curve.slip_force_n, x_p = curve.presliding_m();
  if (curve.law == ContactLaw::kSharpSlip) {
    return 4.0 * s * std::max(0.0, x - x_p);
  }
  // int_0^x g du = x - 2/5 x_s (1 - (1 - x/x_s)^(5/2))
  const double x_s = kPartialSlipReach * x_p;
  const double left = std::max(0.0, 1.0 - x / x_s);
  return 8.0 * s * (x - 0.4 * x_s * (1.0 - std::pow(left, 2.5))) - 4.0 * x * q;
}

}  // namespace palpate
