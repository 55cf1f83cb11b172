#include "fitting/material/moduli.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <boost/math/tools/minima.hpp>
#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kDepthShareMax = 0.25;  // [-] of a sphere's radius
constexpr double kStrainMax = 0.1;       // [-] of a cylinder under a plate
constexpr double kExponentApart = 0.1;
constexpr double kContactShare = 0.4;  // [-] of the depth: how far contact may move
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

Modulus refused(std::string why) {
  Modulus modulus;
  modulus.youngs_modulus_pa = modulus.sd_pa = kNaN;
  modulus.refused = std::move(why);
  return modulus;
}

// Least squares of E in F = E g(x - x0), with the baseline of `fit`.
struct LayerFit {
  double youngs_modulus_pa = 0.0;
  double squares = 0.0;  // [N^2] of the residuals
};

LayerFit fit_layer(const Approach& approach, const ContactFit& fit,
                   const Indenter& indenter, double contact_m) {
  const double nu = indenter.poissons_ratio, R = indenter.radius_m;
  const double b0 = fit.parameters[0].value, b1 = fit.parameters[1].value;
  double product = 0.0, square = 0.0, total = 0.0;
  for (std::size_t i = 0; i < approach.force_n.size(); ++i) {
    const double x = approach.displacement_m[i], d = x - contact_m;
    const double force = approach.force_n[i] - b0 - b1 * x;
    total += force * force;
    if (d > 0.0) {
      const double chi = std::sqrt(R * d) / indenter.thickness_m;
      const double g = 4.0 / 3.0 / (1.0 - nu * nu) * std::sqrt(R) * std::pow(d, 1.5) *
                       sphere_layer_factor(chi, nu);
      product += g * force;
      square += g * g;
    }
  }
  return {product / square, total - product * product / square};
}

// A layer stiffens faster than any power of the depth: the power law's contact point is
// not quite that of the layer's own law.
double layer_modulus_pa(const Approach& approach, const ContactFit& fit,
                        const Indenter& indenter) {
  const double span_m = kContactShare * fit.depth_max_m;
  const auto [contact_m, squares] = boost::math::tools::brent_find_minima(
      [&](double x0) {
        return fit_layer(approach, fit, indenter, x0).squares;
      },
      std::max(fit.contact_point_m - span_m, approach.contact_from_m),
      fit.contact_point_m + span_m, 24);
  static_cast<void>(squares);
  return fit_layer(approach, fit, indenter, contact_m).youngs_modulus_pa;
}

// E over the coefficient K of the law of this exponent.
double per_coefficient(const Indenter& indenter) {
  const double nu = indenter.poissons_ratio, plane = 1.0 - nu * nu;
  if (indenter.shape == "sphere") {
    return 0.75 * plane / std::sqrt(indenter.radius_m);
  }
  if (indenter.shape == "cone") {
    return 0.5 * std::numbers::pi * plane / std::tan(indenter.half_angle_rad);
  }
  const double layer =
      indenter.thickness_m > 0.0
          ? punch_layer_factor(indenter.radius_m / indenter.thickness_m, nu)
          : 1.0;
  return plane / (2.0 * indenter.radius_m * layer);
}

const char* law_of(const Indenter& indenter) {
  const bool layer = indenter.thickness_m > 0.0;
  if (indenter.shape == "sphere") {
    return layer ? "Hertz on a layer" : "Hertz";
  }
  if (indenter.shape == "cone") {
    return "Sneddon cone";
  }
  return layer ? "flat punch on a layer" : "flat punch";
}

// Slope of force over displacement at strains up to kStrainMax: where the plate has met
// the cylinder hardly matters then, so that a missing free travel is no reason to
// refuse.
Modulus plate_modulus(const Approach& approach, const ContactFit& free,
                      const Indenter& indenter) {
  if (free.has(FitFlag::kEmptyRun)) {
    return refused("empty run");
  }
  Approach part = approach;
  part.displacement_m.clear();
  part.force_n.clear();
  const double from = free.contact_point_m + 0.1 * kStrainMax * indenter.height_m;
  const double to = free.contact_point_m + kStrainMax * indenter.height_m;
  for (std::size_t i = 0; i < approach.force_n.size(); ++i) {
    const double x = approach.displacement_m[i];
    if (x >= from && x <= to) {
      part.displacement_m.push_back(x);
      part.force_n.push_back(approach.force_n[i]);
    }
  }
  if (part.force_n.size() < kSamplesMin) {
    return refused(
        fmt::format("fewer than {} samples between 1 and 10 % strain", kSamplesMin));
  }
  const auto n = static_cast<Eigen::Index>(part.force_n.size());
  const Eigen::Map<const Eigen::ArrayXd> x(part.displacement_m.data(), n),
      f(part.force_n.data(), n);
  const Eigen::ArrayXd dx = x - x.mean();
  const double slope = (dx * f).sum() / dx.square().sum();
  const double sd = std::sqrt((f - f.mean() - slope * dx).square().sum() /
                              static_cast<double>(n - 2) / dx.square().sum());
  const double per_slope =
      indenter.height_m / (std::numbers::pi * indenter.radius_m * indenter.radius_m);
  Modulus modulus;
  modulus.law = "plate on cylinder";
  modulus.youngs_modulus_pa = per_slope * slope;
  modulus.sd_pa = per_slope * sd;
  return modulus;
}

double exponent_of(const Indenter& indenter) {
  return indenter.shape == "sphere" ? 1.5 : indenter.shape == "cone" ? 2.0 : 1.0;
}

Modulus contact_modulus(const Approach& approach, const ContactFit& free,
                        const Indenter& indenter) {
  const double exponent = exponent_of(indenter);
  const ContactFit fit = fit_contact(approach, {exponent});
  if (const std::string reason = reason_to_refuse(fit); !reason.empty()) {
    return refused(reason);
  }
  Modulus modulus;
  modulus.law = law_of(indenter);
  modulus.flags = fit.flags;
  std::replace(modulus.flags.begin(), modulus.flags.end(), FitFlag::kMisfit,
               FitFlag::kModulusLawMisfit);
  modulus.youngs_modulus_pa = per_coefficient(indenter) * fit.coefficient;
  modulus.sd_pa = per_coefficient(indenter) * fit.coefficient_sd;
  const bool sphere_on_layer = indenter.shape == "sphere" && indenter.thickness_m > 0.0;
  if (sphere_on_layer) {
    const double thick = modulus.youngs_modulus_pa;
    modulus.youngs_modulus_pa = layer_modulus_pa(approach, free, indenter);
    modulus.sd_pa *= modulus.youngs_modulus_pa / thick;
  }
  if (indenter.shape == "sphere" &&
      fit.depth_max_m > kDepthShareMax * indenter.radius_m) {
    modulus.flags.push_back(FitFlag::kHertzDepthExceeded);
  }
  const double apart = std::abs(free.exponent - exponent);
  if (!sphere_on_layer && apart > kExponentApart &&
      !(apart <= kDeviations * free.parameters[3].sd)) {
    modulus.flags.push_back(FitFlag::kHertzExponentRefuted);
  }
  return modulus;
}

}  // namespace

Modulus find_modulus(const Approach& approach, const ContactFit& free,
                     const Indenter& indenter) {
  if (indenter.shape == "unknown") {
    return refused("the indenter's geometry is not known");
  }
  if (indenter.shape == "plate") {
    return plate_modulus(approach, free, indenter);
  }
  if (const std::string reason = reason_to_refuse(free); !reason.empty()) {
    return refused(reason);
  }
  try {
    return contact_modulus(approach, free, indenter);
  } catch (const InputError& error) {
    return refused(error.what());
  }
}

}  // namespace palpate
