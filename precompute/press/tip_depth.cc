#include "precompute/press/tip_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "formats/base/reproducible.h"
#include "formats/response/response_curve.h"

namespace palpate {
namespace {

// F / (E R^2), halfway between Poisson's ratio at small depths and deep down.
constexpr double kHalfWayForce = 2.0;

double two_thirds_power(double x) {
  const double root = reproducible::cbrt(x);
  return root * root;
}

// E / (1 - nu^2)
double plane_modulus_pa(const TipTissue& tissue) {
  return tissue.youngs_modulus_pa /
         (1.0 - tissue.poissons_ratio * tissue.poissons_ratio);
}

// h / R of a neo-Hookean half-space of nu = 1/2, over (F / (E R^2))^(2/3). By Hertz the
// curve is straight; so it is smooth from the start.
const ResponseCurve& deep_tip_curve() {
  static constexpr std::array<double, 17> kRadii = {0.0, 0.05, 0.1, 0.2, 0.3, 0.5,
                                                    0.7, 1.0,  1.5, 2.0, 2.5, 3.0,
                                                    3.5, 4.0,  4.5, 5.0, 5.5};
  static constexpr std::array<double, 17> kForce = {
      0.0,   0.0195, 0.0546, 0.1515, 0.273, 0.568, 0.908, 1.465, 2.42,
      3.262, 3.972,  4.69,   5.472,  6.285, 7.13,  8.005, 8.90};
  static const ResponseCurve curve = [] {
    std::array<double, kForce.size()> power = {};
    std::ranges::transform(kForce, power.begin(), two_thirds_power);
    return ResponseCurve(power, kRadii);
  }();
  return curve;
}

// h / R at F / (E R^2) for nu = 1/2.
double deep_tip_radii(double force) {
  const ResponseCurve& curve = deep_tip_curve();
  const double power = two_thirds_power(force);
  const double last_power = curve.depth_max_m();
  if (power <= last_power) {
    return curve.at(power).force_n;
  }
  // dx/df falls to 3 / (2 pi) from that of the curve's end, as f^(-3/2).
  constexpr double kDeep = 1.5 / std::numbers::pi;
  const double root = std::sqrt(last_power);
  const double last_force = last_power * root;
  const ResponseSample last = curve.at(last_power);
  const double last_slope = last.stiffness_n_per_m / (1.5 * root);
  return last.force_n + kDeep * (force - last_force) +
         2.0 * (last_slope - kDeep) * last_force *
             (1.0 - std::sqrt(last_force / force));
}

}  // namespace

double linear_tip_depth_m(const TipTissue& tissue, double radius_m, double force_n) {
  if (!(force_n > 0.0)) {
    return 0.0;
  }
  const double wanted = force_n / (plane_modulus_pa(tissue) * radius_m * radius_m);
  // (1 + tanh^2 t) t - tanh t is (4/3) t^3 for small t and 2 t - 1 for large t. It is
  // convex, and Newton from above falls to the root.
  double t = std::max(reproducible::cbrt(0.75 * wanted), 0.5 * (wanted + 1.0));
  for (int i = 0; i < 60; ++i) {
    const double s = reproducible::tanh(t);
    const double slope = s * s + 2.0 * t * s * (1.0 - s * s) + s * s;
    const double step = ((1.0 + s * s) * t - s - wanted) / slope;
    t -= step;
    if (!(std::abs(step) > 1e-14 * t)) {
      break;
    }
  }
  return radius_m * t * reproducible::tanh(t);
}

double nonlinear_tip_depth_m(const TipTissue& tissue, double radius_m, double force_n) {
  if (!(force_n > 0.0)) {
    return 0.0;
  }
  const double nu = tissue.poissons_ratio;
  const double shallow = 0.75 / (1.0 - nu * nu);
  const double deep = 1.5 / (1.0 + nu);
  const double force = force_n / (tissue.youngs_modulus_pa * radius_m * radius_m);
  const double factor = deep - (deep - shallow) / (1.0 + force / kHalfWayForce);
  return radius_m * deep_tip_radii(force / factor);
}

double linear_cone_depth_m(const TipTissue& tissue, const NeedleTip& tip,
                           double force_n) {
  if (!(force_n > 0.0)) {
    return 0.0;
  }
  constexpr double kPi = std::numbers::pi;
  const double plane_pa = plane_modulus_pa(tissue);
  const double tangent = reproducible::tan(tip.half_angle_rad);
  const double full_n = 0.5 * kPi * plane_pa * tip.radius_m * tip.radius_m / tangent;
  const double cone_m =
      std::sqrt(0.5 * kPi * std::min(force_n, full_n) / (plane_pa * tangent));
  return cone_m + std::max(0.0, force_n - full_n) / (2.0 * plane_pa * tip.radius_m);
}

}  // namespace palpate
