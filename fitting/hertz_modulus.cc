#include "fitting/hertz_modulus.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "formats/error.h"

namespace palpate {
namespace {

constexpr double kHertzExponent = 1.5;
constexpr double kDepthShareMax = 0.25;  // [-] of the radius
constexpr double kExponentApart = 0.1;
constexpr double kDeviations = 3.0;

std::string reason_to_refuse(const ContactFit& fit) {
  if (fit.has(FitFlag::kEmptyRun)) {
    return "empty run";
  }
  if (fit.has(FitFlag::kAlreadyInContact)) {
    return "already in contact at the first sample: the depth is not known";
  }
  if (fit.has(FitFlag::kContactPointNotIdentified)) {
    return "contact point not identified: the depth is not known";
  }
  return "";
}

}  // namespace

HertzModulus hertz_modulus(const Approach& approach, const ContactFit& free,
                           double radius_m, double poissons_ratio) {
  if (!(radius_m > 0.0) || !std::isfinite(radius_m)) {
    throw InputError(
        fmt::format("sphere radius is {} m, must be positive and finite", radius_m));
  }
  if (!(poissons_ratio > -1.0 && poissons_ratio <= 0.5)) {
    throw InputError(
        fmt::format("Poisson's ratio is {}, must lie in (-1, 0.5]", poissons_ratio));
  }
  HertzModulus result;
  result.youngs_modulus_pa = result.sd_pa = std::numeric_limits<double>::quiet_NaN();
  result.refused = reason_to_refuse(free);
  if (!result.refused.empty()) {
    return result;
  }
  result.fit = fit_contact(approach, {kHertzExponent});
  result.refused = reason_to_refuse(result.fit);
  if (!result.refused.empty()) {
    return result;
  }
  const double nu = poissons_ratio;
  const double per_coefficient = 3.0 * (1.0 - nu * nu) / (4.0 * std::sqrt(radius_m));
  result.youngs_modulus_pa = per_coefficient * result.fit.coefficient;
  result.sd_pa = per_coefficient * result.fit.coefficient_sd;
  if (result.fit.depth_max_m > kDepthShareMax * radius_m) {
    result.fit.flags.push_back(FitFlag::kHertzDepthExceeded);
  }
  const double apart = std::abs(free.exponent - kHertzExponent);
  const double sd = free.parameters[3].sd;
  if (apart > kExponentApart && !(apart <= kDeviations * sd)) {
    result.fit.flags.push_back(FitFlag::kHertzExponentRefuted);
  }
  return result;
}

}  // namespace palpate
