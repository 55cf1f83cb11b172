#include "fitting/material/moduli.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include <Eigen/Core>
#include <fmt/format.h>

#include "fitting/curve/free_travel.h"
#include "fitting/curve/law_error.h"
#include "fitting/material/layer_fit.h"
#include "fitting/numerics/correlated_noise.h"
#include "fitting/numerics/least_squares.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr double kHertzDepthShareMax = 0.25;  // [-] of a sphere's radius
constexpr double kStrainMax = 0.1;            // [-] of a cylinder under a plate
constexpr double kHalvesApart = 0.15;         // [-] of the slope
constexpr double kExponentApart = 0.1;
constexpr double kSdStep = 0.5;  // [-] of a standard deviation, for derivatives
constexpr double kExponentDeviations = 3.0;
constexpr double kSameExponent = 2.0;  // standard deviations

std::string no_contact_point(double sd_m, double depth_m) {
  const double share = sd_m / depth_m;
  const std::string why =
      !(share == share) ? std::string("its standard deviation is not known")
      : share > kContactSdShareMax
          ? fmt::format(
                "its standard deviation {:.2g} m is {:.2g} % of the depth, more "
                "than {:g} %",
                sd_m, 100.0 * share, 100.0 * kContactSdShareMax)
          : std::string("the law follows no beginning of the curve");
  return fmt::format(
      "contact point not identified: {}; tell displacements that are surely free "
      "(--baseline-m, [fit] baseline_m)",
      why);
}

// @param layer its own law finds the contact point then.
std::string reason_to_refuse(const ContactFit& fit, bool layer) {
  if (fit.has(FitFlag::kEmptyRun)) {
    return "empty run";
  }
  if (fit.has(FitFlag::kAlreadyInContact)) {
    return "already in contact at the first sample: the depth is not known";
  }
  return !layer && fit.has(FitFlag::kContactPointNotIdentified)
             ? no_contact_point(fit.contact.sd_m, fit.depth_max_m)
             : "";
}

// Where a free exponent leaves the contact point open, but does not speak against the
// tip's, its law may know it.
bool may_be_known_by_law(const ContactFit& free, double exponent) {
  return free.converged && free.beginning == nullptr && !free.has(FitFlag::kEmptyRun) &&
         !free.has(FitFlag::kAlreadyInContact) &&
         std::abs(free.exponent - exponent) <= kSameExponent * free.parameters[3].sd;
}

bool on_a_layer(const Indenter& indenter) {
  return indenter.shape == "sphere" && indenter.thickness_m > 0.0;
}

Modulus refused_modulus(std::string why) {
  Modulus modulus;
  modulus.youngs_modulus_pa = modulus.sd_pa = std::nan("");
  modulus.refused = std::move(why);
  return modulus;
}

// E over the coefficient K of the law of this exponent.
double per_coefficient(const Indenter& indenter) {
  // F = K d^p; E over K, by Hertz 1882 and Sneddon 1965:
  //   sphere  K = 4/3 sqrt(R) E / (1 - nu^2)
  //   cone    K = 2/pi tan(half angle) E / (1 - nu^2)
  //   punch   K = 2 R E / (1 - nu^2), times the layer's factor
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

double exponent_of(const Indenter& indenter) {
  return indenter.shape == "sphere" ? 1.5 : indenter.shape == "cone" ? 2.0 : 1.0;
}

// E and its standard deviation from the samples alone.
struct FromData {
  double youngs_modulus_pa = 0.0;
  double sd_pa = 0.0;
};

FromData contact_modulus(const Approach& approach, const ContactFit& held,
                         const ContactFit& free, const Indenter& indenter) {
  if (on_a_layer(indenter)) {
    const LayerFit fit = fit_sphere_on_layer(approach, free, indenter);
    if (!(fit.contact_point_sd_m <= kContactSdShareMax * free.depth_max_m)) {
      throw InputError(no_contact_point(fit.contact_point_sd_m, free.depth_max_m));
    }
    return {fit.youngs_modulus_pa, fit.sd_pa};
  }
  const double modulus_pa = per_coefficient(indenter) * held.coefficient;
  const Eigen::VectorXd depth_m = Eigen::VectorXd::Constant(1, held.depth_max_m);
  return {modulus_pa, modulus_pa * log_force_errors(approach, held, depth_m)[0]};
}

// What one standard deviation of each of the indenter's numbers makes of E.
std::vector<ModulusError> geometry_errors(
    const Indenter& indenter,
    const std::function<double(const Indenter&)>& modulus_pa) {
  struct Number {
    const char* name;
    double Indenter::*value;
    double sd, low, high;
  };
  const Number numbers[] = {
      {"radius", &Indenter::radius_m, indenter.radius_sd_m, 0.0, kInf},
      {"half_angle", &Indenter::half_angle_rad, indenter.half_angle_sd_rad, 0.0,
       0.5 * std::numbers::pi},
      {"height", &Indenter::height_m, indenter.height_sd_m, 0.0, kInf},
      {"thickness", &Indenter::thickness_m, indenter.thickness_sd_m, 0.0, kInf},
      {"poissons_ratio", &Indenter::poissons_ratio, indenter.poissons_ratio_sd, -1.0,
       0.5}};
  std::vector<ModulusError> errors;
  for (const Number& number : numbers) {
    if (!(number.sd > 0.0)) {
      continue;
    }
    // Error |dE/dv| sd_v of each number v, by a central difference half a sd to each
    // side. The step is cut at the ends of what v may be.
    Indenter less = indenter, more = indenter;
    const double step = kSdStep * number.sd, value = indenter.*number.value;
    less.*number.value = std::max(value - step, number.low + 0.1 * step);
    more.*number.value = std::min(value + step, number.high);
    const double slope = (modulus_pa(more) - modulus_pa(less)) /
                         (more.*number.value - less.*number.value);
    errors.push_back({number.name, std::abs(slope) * number.sd});
  }
  return errors;
}

Modulus with_errors(double modulus_pa, std::vector<ModulusError> errors) {
  Modulus modulus;
  modulus.youngs_modulus_pa = modulus_pa;
  for (const ModulusError& error : errors) {
    modulus.sd_pa = std::hypot(modulus.sd_pa, error.sd_pa);
  }
  modulus.error = std::move(errors);
  return modulus;
}

struct Slope {
  double n_per_m = 0.0, sd = 0.0;
};

// Of force over displacement at displacements of a range.
Slope slope_within(const Approach& approach, double from, double to) {
  std::vector<double> x, f;
  for (std::size_t i = 0; i < approach.force_n.size(); ++i) {
    if (approach.displacement_m[i] >= from && approach.displacement_m[i] <= to) {
      x.push_back(approach.displacement_m[i]);
      f.push_back(approach.force_n[i]);
    }
  }
  if (f.size() < kSamplesMin) {
    throw InputError(fmt::format(
        "fewer than {} samples between 1 and 10 % strain, counted from the contact "
        "point",
        kSamplesMin));
  }
  const auto n = std::ssize(f);
  const Eigen::Map<const Eigen::ArrayXd> xs(x.data(), n), fs(f.data(), n);
  // Columns 1 and x - mean(x) are orthogonal: the slope needs no more than the second.
  Eigen::MatrixXd J(n, 2);
  J << Eigen::VectorXd::Ones(n), (xs - xs.mean()).matrix();
  const double slope = J.col(1).dot(fs.matrix()) / J.col(1).squaredNorm();
  const Eigen::VectorXd residual = fs - fs.mean() - slope * J.col(1).array();
  return {slope, std::sqrt(covariance_under_noise(J, residual, n,
                                                  SharedNoise::kAlsoRegression)(1, 1))};
}

// At strains up to kStrainMax, with what an error of the contact point and a curve that
// is no line there make of it. On a line it hardly matters where the plate has met the
// cylinder, so that a missing free travel is no reason to refuse.
struct PlateSlope {
  double slope = 0.0, data_sd = 0.0, contact_sd = 0.0, law_sd = 0.0;
};

PlateSlope plate_slope(const Approach& approach, const ContactFit& free,
                       double height_m) {
  const double length = kStrainMax * height_m;
  const auto within = [&](double contact_m, double first, double last) {
    return slope_within(approach, contact_m + first * length,
                        contact_m + last * length);
  };
  // Strains from kStrainMax / 10 to kStrainMax of the height, from the contact point
  // on.
  const double at = free.contact.m, middle = 0.5 * (0.1 + 1.0);
  const Slope all = within(at, 0.1, 1.0);
  PlateSlope found{all.n_per_m, all.sd};
  const double sd_m = std::min(free.contact.sd_m, length);
  if (sd_m > 0.0) {
    found.contact_sd = std::abs(within(at + kSdStep * sd_m, 0.1, 1.0).n_per_m -
                                within(at - kSdStep * sd_m, 0.1, 1.0).n_per_m) /
                       (2.0 * kSdStep);
  }
  // The two halves' slopes: where they differ surely, the curve is no line.
  const Slope less = within(at, 0.1, middle), more = within(at, middle, 1.0);
  const double apart = std::abs(more.n_per_m - less.n_per_m);
  if (apart > kExponentDeviations * std::hypot(less.sd, more.sd) &&
      apart > kHalvesApart * std::abs(all.n_per_m)) {
    found.law_sd = 0.5 * apart;
  }
  return found;
}

Modulus plate_modulus(const Approach& approach, const ContactFit& free,
                      const Indenter& indenter) {
  if (free.has(FitFlag::kEmptyRun)) {
    throw InputError("empty run");
  }
  // E = slope h / (pi R^2): force over area, displacement over height.
  const PlateSlope found = plate_slope(approach, free, indenter.height_m);
  const auto per_slope = [](const Indenter& at) {
    return at.height_m / (std::numbers::pi * at.radius_m * at.radius_m);
  };
  std::vector<ModulusError> errors = geometry_errors(indenter, [&](const Indenter& at) {
    return per_slope(at) * found.slope;
  });
  const double per = per_slope(indenter);
  errors.insert(errors.begin(), {{"data", per * found.data_sd},
                                 {"contact", per * found.contact_sd},
                                 {"law", per * found.law_sd}});
  std::erase_if(errors, [](const ModulusError& error) {
    return error.sd_pa == 0.0 && error.name != "data";
  });
  Modulus modulus = with_errors(per * found.slope, std::move(errors));
  modulus.law = "plate on cylinder, strains 1 to 10 %";
  if (found.law_sd > 0.0) {
    modulus.flags.push_back(FitFlag::kModulusLawMisfit);
  }
  return modulus;
}

Modulus indented_modulus(const Approach& approach, const ContactFit& free,
                         const Indenter& indenter) {
  const double exponent = exponent_of(indenter);
  const bool layer = on_a_layer(indenter);
  const ContactFitOptions given{.exponent = exponent,
                                .noise_relative = free.noise_relative};
  const ContactFit fit = fit_contact(approach, given);
  if (const std::string reason = reason_to_refuse(fit, layer); !reason.empty()) {
    return refused_modulus(reason);
  }
  const FromData found = contact_modulus(approach, fit, free, indenter);
  std::vector<ModulusError> errors = geometry_errors(indenter, [&](const Indenter& at) {
    return contact_modulus(approach, fit, free, at).youngs_modulus_pa;
  });
  errors.insert(errors.begin(), {"data", found.sd_pa});
  if (const auto bend = bend_of_drift(approach, fit)) {
    std::array<ContactFit, 2> other;
    std::array<double, 2> moved_pa{};
    for (std::size_t k = 0; k < 2; ++k) {
      other[k] = fit_contact(bend->straight[k], given);
      if (other[k].has(FitFlag::kEmptyRun)) {
        return refused_modulus("a drift that bends may be all of the force");
      }
      moved_pa[k] = contact_modulus(bend->straight[k], other[k], free, indenter)
                        .youngs_modulus_pa -
                    found.youngs_modulus_pa;
    }
    errors.push_back({"drift", bend_sd(*bend, fit, other, moved_pa)});
  }
  Modulus modulus = with_errors(found.youngs_modulus_pa, std::move(errors));
  modulus.law = law_of(indenter);
  modulus.flags = fit.flags;
  if (layer) {
    std::erase(modulus.flags, FitFlag::kMisfit);  // of the power law, not of this one
  }
  std::replace(modulus.flags.begin(), modulus.flags.end(), FitFlag::kMisfit,
               FitFlag::kModulusLawMisfit);
  if (indenter.shape == "sphere" &&
      fit.depth_max_m > kHertzDepthShareMax * indenter.radius_m) {
    modulus.flags.push_back(FitFlag::kHertzDepthExceeded);
  }
  const double apart = std::abs(free.exponent - exponent);
  if (!layer && apart > kExponentApart &&
      !(apart <= kExponentDeviations * free.parameters[3].sd)) {
    modulus.flags.push_back(FitFlag::kHertzExponentRefuted);
  }
  return modulus;
}

}  // namespace

Modulus find_modulus(const Approach& approach, const ContactFit& free,
                     const Indenter& indenter) {
  if (indenter.shape == "unknown") {
    return refused_modulus("the indenter's geometry is not known");
  }
  try {
    if (indenter.shape == "plate") {
      return plate_modulus(approach, free, indenter);
    }
    if (const std::string reason = reason_to_refuse(free, on_a_layer(indenter));
        !reason.empty() && !may_be_known_by_law(free, exponent_of(indenter))) {
      return refused_modulus(reason);
    }
    return indented_modulus(approach, free, indenter);
  } catch (const Error& error) {
    return refused_modulus(error.what());
  }
}

}  // namespace palpate
